#include "algorithms/backface/direction_cube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "common/scene/error.h"

namespace vislab::backface_culling {
namespace {

static_assert(SidePoints::most > DirectionCube::max_n);

constexpr int axis_of(int side) { return side / 2; }
constexpr float sign_of(int side) { return side % 2 == 0 ? 1.0F : -1.0F; }

/// Bits one after the other.
class BitString {
 public:
  /// `bits` below 2^count, count <= 32.
  void append(std::uint32_t bits, std::uint32_t count) {
    word_ |= std::uint64_t{bits} << filled_;
    filled_ += count;
    if (filled_ < 64) return;
    words_[full_++] = word_;
    filled_ -= 64;
    word_ = std::uint64_t{bits} >> (count - filled_);
  }

  void write(BackMask& mask) {
    words_[full_] = word_;
    for (std::size_t word = 0; word <= full_; ++word) {
      for (std::size_t k = 0; k < 8; ++k) {
        mask.bytes[8 * word + k] = static_cast<std::uint8_t>(words_[word] >> (8 * k));
      }
    }
  }

 private:
  std::array<std::uint64_t, sizeof(BackMask) / 8> words_{};
  std::uint64_t word_ = 0;
  std::uint32_t filled_ = 0;
  std::size_t full_ = 0;
};

}  // namespace

DirectionCube::DirectionCube(int n, ClassTest test) : n_(n), test_(test) {
  if (n < 1 || n > max_n) {
    throw InputError("normal masks: n = " + std::to_string(n) +
                     " is not allowed; allowed: 1 to 18, because 6 n^2 classes have to fit into "
                     "256 bytes of 8, which is what one byte of offset can tell apart");
  }
  const bool corners = test == ClassTest::corners;
  for (int i = 0; i < (corners ? n + 1 : n); ++i) {
    lines_.push_back(static_cast<float>(-1.0 + (2.0 * i + (corners ? 0.0 : 1.0)) / n));
  }
}

std::optional<int> DirectionCube::class_of(const glm::dvec3& normal, double error) const {
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  // Written so that what is not a number has no class.
  if (!(size[axis] > error * 0x1p23) || !std::isfinite(size.x + size.y + size.z)) {
    return std::nullopt;
  }
  const auto cell = [&](int other) {
    const double quotient = normal[other] / size[axis];
    return std::clamp(static_cast<int>(std::floor((quotient + 1.0) * 0.5 * n_)), 0, n_ - 1);
  };
  const int side = 2 * axis + (normal[axis] < 0.0 ? 1 : 0);
  return (side * n_ + cell((axis + 2) % 3)) * n_ + cell((axis + 1) % 3);
}

std::optional<int> DirectionCube::class_of(const Mesh& mesh, std::uint32_t triangle) const {
  const glm::uvec3& vertices = mesh.triangles[triangle];
  const glm::dvec3 a(mesh.positions[vertices.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[vertices.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[vertices.z]) - a;
  const glm::dvec3 forward(u.y * v.z, u.z * v.x, u.x * v.y);
  const glm::dvec3 backward(u.z * v.y, u.x * v.z, u.y * v.x);
  const glm::dvec3 sizes = glm::abs(forward) + glm::abs(backward);
  // 4.01 x 2^-53 of the greatest sum, rounded up.
  return class_of(forward - backward, 0x1.02p-51 * std::max({sizes.x, sizes.y, sizes.z}));
}

std::array<glm::vec3, 4> DirectionCube::corners(int class_index) const {
  const int side = class_index / (n_ * n_);
  const int row = class_index / n_ % n_;
  const int column = class_index % n_;
  std::array<glm::vec3, 4> points;
  for (int k = 0; k < 4; ++k) {
    const auto line = [&](int i) { return static_cast<float>(-1.0 + 2.0 * i / n_); };
    const int axis = axis_of(side);
    points[k][axis] = sign_of(side);
    points[k][(axis + 1) % 3] = line(column + k % 2);
    points[k][(axis + 2) % 3] = line(row + k / 2);
  }
  return points;
}

BackMask DirectionCube::facing_away(const MeshDirection& v) const {
  BackMask mask;
  const bool corners = test_ == ClassTest::corners;
  const float limit = corners ? 0x1p-18F + 3.0F * v.error : 0.0F;
  if (!(limit < 1.0F)) return mask;
  BitString string;
  const auto n = static_cast<std::uint32_t>(n_);
  const std::uint32_t all = (1U << n) - 1;
  for (int side = 0; side < 6; ++side) {
    const int axis = axis_of(side);
    const float out = sign_of(side) * v.direction[axis];
    const float along_row = v.direction[(axis + 1) % 3];
    const float along_column = v.direction[(axis + 2) % 3];
    SidePoints points;
    for (std::size_t j = 0; j < lines_.size(); ++j) points.rows[j] = lines_[j] * along_column + out;
    // Rounding keeps the order, so that the extreme values are at corners of the side.
    const float rise = std::abs(lines_.front() * along_row);
    const auto [least, most] = std::minmax(points.rows[0], points.rows[lines_.size() - 1]);
    if (least - rise > limit || !(most + rise > limit)) {
      for (std::uint32_t row = 0; row < n; ++row) string.append(least - rise > limit ? all : 0, n);
      continue;
    }
    // Along a row values rise or fall throughout, also as rounded: those above the limit are the
    // first ones or the last ones.
    std::array<std::uint32_t, SidePoints::most> above;
    for (std::size_t i = 0; i < lines_.size(); ++i) points.columns[i] = lines_[i] * along_row;
    count_above(points, lines_.size(), limit, above.data());
    for (std::uint32_t row = 0; row < n; ++row) {
      // A square's row lies between two lines, and its columns between two points of each.
      std::uint32_t squares = above[row];
      if (corners) squares = std::max(std::min(squares, above[row + 1]), 1U) - 1;
      string.append(along_row > 0.0F ? all & ~(all >> squares) : all & ~(all << squares), n);
    }
  }
  string.write(mask);
  return mask;
}

BackMask operator&(const BackMask& a, const BackMask& b) {
  BackMask both;
  for (std::size_t i = 0; i < both.bytes.size(); ++i) both.bytes[i] = a.bytes[i] & b.bytes[i];
  return both;
}

}  // namespace vislab::backface_culling
