#include "kluft/core/change_size.hpp"

#include <new>

#include <gtest/gtest.h>

namespace kluft {
namespace {

// 2^60 bytes are more than any system gives. A vector that gave its old room back twice would end the test.
TEST(ChangeSize, LeavesAnEmptyVectorWhereThereIsNoMemory) {
    Eigen::VectorXd vector(1000);
    EXPECT_THROW(change_size(vector, Eigen::Index{1} << 57), std::bad_alloc);
    EXPECT_EQ(vector.size(), 0);
    Eigen::MatrixXd matrix(10, 100);
    EXPECT_THROW(change_size(matrix, Eigen::Index{1} << 30, Eigen::Index{1} << 27), std::bad_alloc);
    EXPECT_EQ(matrix.size(), 0);
}

TEST(ChangeSize, KeepsAMatrixOfThatSize) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(2, 3);
    const double* const room = matrix.data();
    change_size(matrix, 2, 3);
    EXPECT_EQ(matrix.data(), room);
    EXPECT_EQ(matrix.sum(), 6.0);
    change_size(matrix, 3, 2);
    EXPECT_EQ(matrix.rows(), 3);
    EXPECT_EQ(matrix.cols(), 2);
}

} // namespace
} // namespace kluft
