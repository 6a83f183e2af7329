// Stiffness matrices of small bodies of hexagons for tests of the linear algebra.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

/// Neighbours in a net of side x side hexagons.
inline std::vector<std::pair<int, int>> hexagon_pairs(int side) {
    std::vector<std::pair<int, int>> pairs;
    const auto block = [side](int column, int row) { return row * side + column; };
    for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
            if (column + 1 < side) pairs.emplace_back(block(column, row), block(column + 1, row));
            if (row + 1 == side) continue;
            pairs.emplace_back(block(column, row), block(column, row + 1));
            const int oblique = row % 2 == 0 ? column - 1 : column + 1;
            if (oblique >= 0 && oblique < side) pairs.emplace_back(block(column, row), block(oblique, row + 1));
        }
    }
    return pairs;
}

/// Symmetric positive definite: four random springs between neighbours, and a weak one of every unknown to the ground.
inline BlockMatrix hexagon_matrix(const BlockPattern& pattern, std::mt19937& generator) {
    std::normal_distribution<double> value;
    BlockMatrix matrix;
    matrix.reset(pattern);
    for (int a = 0; a < pattern.n_blocks(); ++a) {
        matrix.values[pattern.find(a, a)] += 0.1 * Mat6::Identity();
        for (int entry = pattern.row_start(a); entry < pattern.row_start(a + 1); ++entry) {
            const int b = pattern.column(entry);
            if (b <= a) continue;
            Eigen::Matrix<double, 4, 12> springs;
            for (int i = 0; i < 48; ++i) springs(i / 12, i % 12) = value(generator);
            const Eigen::Matrix<double, 12, 12> stiffness = springs.transpose() * springs;
            matrix.values[pattern.find(a, a)] += stiffness.topLeftCorner<6, 6>();
            matrix.values[entry] += stiffness.topRightCorner<6, 6>();
            matrix.values[pattern.find(b, a)] += stiffness.bottomLeftCorner<6, 6>();
            matrix.values[pattern.find(b, b)] += stiffness.bottomRightCorner<6, 6>();
        }
    }
    return matrix;
}

/// The same, with unsymmetric couplings of a third of the springs' size between neighbours, as friction makes them.
inline BlockMatrix unsymmetric_hexagon_matrix(const BlockPattern& pattern, std::mt19937& generator) {
    BlockMatrix matrix = hexagon_matrix(pattern, generator);
    std::normal_distribution<double> value(0.0, 0.3);
    for (int a = 0; a < pattern.n_blocks(); ++a) {
        for (int entry = pattern.row_start(a); entry < pattern.row_start(a + 1); ++entry) {
            for (int i = 0; i < 36; ++i) matrix.values[entry](i / 6, i % 6) += value(generator);
        }
    }
    return matrix;
}

} // namespace kluft
