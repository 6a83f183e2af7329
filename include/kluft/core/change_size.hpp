// Another size for a matrix of Eigen, also where there is no memory.
#pragma once

#include <Eigen/Core>

namespace kluft {

/// Gives the matrix, or the vector (columns: 1), this size; its entries are lost unless it has it already. Eigen's own
/// resize gives the old room back before it asks for the new one, and where it gets none, the destructor gives the old
/// one back again. Throws std::bad_alloc; the matrix is empty then.
template <class Matrix> void change_size(Matrix& matrix, Eigen::Index rows, Eigen::Index columns = 1) {
    if (matrix.rows() == rows && matrix.cols() == columns) return;
    matrix = Matrix();
    matrix.resize(rows, columns);
}

} // namespace kluft
