// Why a load step, and with it a run, cannot go on: a result like any other.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/moving_block.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

enum class FailureKind {
    no_equilibrium, ///< none was found at the load level
    falling,        ///< blocks move on at a load that does not change
    broken_body,    ///< displacements that are those of a body no more
    too_many_solves ///< the load step took as many as it may: what it would come to is not known
};

struct Failure {
    FailureKind kind = FailureKind::no_equilibrium;
    int worst_block = -1;        ///< with the largest residual; -1 where none was computed
    double residual_ratio = 0.0; ///< what is left, over F_ref
    double load_factor = 1.0;
    double strength_factor = 1.0;    ///< F that strengths were divided by
    bool nothing_holds = false;      ///< the body, which has neither a support nor a platen
    std::vector<MovingBlock> moving; ///< blocks that are not balanced, the worst first
    std::vector<MovingBlock> along;  ///< of a fall, see moving_along; none that is in `moving`
    std::string what;                ///< in place of the residual, of a broken body or a motion

    /// Whether the body may just have reached what it carries, where its load is a stress.
    [[nodiscard]] bool may_be_collapse() const {
        return !nothing_holds && (kind == FailureKind::no_equilibrium || kind == FailureKind::falling);
    }
};

/// Where blocks have moved away in the load step, from the displacements `before` to `now`, they go on in that direction
/// and turn on, whatever pushes them at the moment.
[[nodiscard]] std::vector<MovingBlock> moving_on(const BlockSystem& system, const Eigen::VectorXd& before,
                                                 const Eigen::VectorXd& now, std::vector<MovingBlock> moving);

/// What moves along with blocks that fall, from the displacements `before` to `now`: all that have moved by 0.3 of the farthest motion of a
/// block or more, and are joined to one of `moving` by interfaces of the body as cut through others that have. Without those of `moving`.
[[nodiscard]] std::vector<MovingBlock> moving_along(const BlockSystem& system, const Eigen::VectorXd& before,
                                                    const Eigen::VectorXd& now, const std::vector<MovingBlock>& moving);

/// Those that are not balanced, and after them what moves along.
[[nodiscard]] std::vector<MovingBlock> all_moving(const Failure& failure);

/// In words the blocks that move and where to; "" without any.
[[nodiscard]] std::string description(const Model& model, const std::vector<MovingBlock>& moving);

/// In words that follow "no equilibrium in stage 1 at load step 7: ", with the block and its interfaces.
[[nodiscard]] std::string description(const Model& model, const Failure& failure);

} // namespace kluft
