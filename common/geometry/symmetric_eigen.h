// Eigenvalues and eigenvectors of small symmetric matrices.
#pragma once

#include <glm/glm.hpp>

namespace vislab {

struct SymmetricEigen {
  glm::dvec3 values;   // descending
  glm::dmat3 vectors;  // orthonormal, one a column, in the order of the values, right-handed
};

/// Of a symmetric matrix; only its upper triangle is read. Repeated eigenvalues have some
/// orthonormal vectors of their space; a diagonal matrix has the coordinate axes.
/// Source: Jacobi's method of plane rotations (Golub and Van Loan, Matrix Computations, 8.5).
SymmetricEigen symmetric_eigen(const glm::dmat3& matrix);

}  // namespace vislab
