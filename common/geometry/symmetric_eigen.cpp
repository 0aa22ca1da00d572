// Idea: rotations in the three coordinate planes, each of which makes one element off the diagonal
//   zero, until none is left that matters.
// Guarantee: the vectors are orthonormal and the values right to a few ulp of the largest.
// Cost: a handful of sweeps of three rotations.
// Source: Golub and Van Loan, Matrix Computations, 8.5.
#include "common/geometry/symmetric_eigen.h"

#include <array>
#include <cmath>
#include <utility>

namespace vislab {
namespace {

constexpr int sweeps_at_most = 32;  // quadratic convergence: six are usual

/// Makes matrix[p][q] zero by a rotation, which is added to `vectors`.
void rotate(glm::dmat3& matrix, glm::dmat3& vectors, int p, int q) {
  const double off = matrix[q][p];
  if (off == 0.0) return;
  const double theta = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
  const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0);
  const double s = t * c;
  glm::dmat3 rotation(1.0);
  rotation[p][p] = rotation[q][q] = c;
  rotation[q][p] = s;
  rotation[p][q] = -s;
  matrix = glm::transpose(rotation) * matrix * rotation;
  matrix[q][p] = matrix[p][q] = 0.0;
  vectors = vectors * rotation;
}

}  // namespace

SymmetricEigen symmetric_eigen(const glm::dmat3& matrix) {
  glm::dmat3 rest = matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < row; ++column) rest[column][row] = matrix[row][column];
  }
  glm::dmat3 vectors(1.0);
  for (int sweep = 0; sweep < sweeps_at_most; ++sweep) {
    const double off = std::abs(rest[1][0]) + std::abs(rest[2][0]) + std::abs(rest[2][1]);
    const double on = std::abs(rest[0][0]) + std::abs(rest[1][1]) + std::abs(rest[2][2]);
    if (off <= 0x1p-60 * on) break;
    rotate(rest, vectors, 0, 1);
    rotate(rest, vectors, 0, 2);
    rotate(rest, vectors, 1, 2);
  }
  std::array<int, 3> order{0, 1, 2};
  // Equal values keep their order. By hand: std::stable_sort takes memory.
  for (const std::size_t first : {0U, 1U, 0U}) {
    const int a = order[first];
    const int b = order[first + 1];
    if (rest[b][b] > rest[a][a]) std::swap(order[first], order[first + 1]);
  }
  SymmetricEigen result;
  for (int i = 0; i < 3; ++i) {
    const int from = order[static_cast<std::size_t>(i)];
    result.values[i] = rest[from][from];
    result.vectors[i] = vectors[from];
  }
  // The rotations' rounding adds up; volumes that enclose rely on orthonormal vectors.
  glm::dmat3& v = result.vectors;
  v[0] = glm::normalize(v[0]);
  v[1] = glm::normalize(v[1] - v[0] * glm::dot(v[0], v[1]));
  v[2] = glm::cross(v[0], v[1]);
  return result;
}

}  // namespace vislab
