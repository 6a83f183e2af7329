#include "kluft/simulation/left_platen.hpp"

#include <atomic>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Watching : public StepObserver {
public:
    explicit Watching(const Model& model) : watch(model) {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>&, bool) override {
        watch.step(record, state);
    }
    PlatenWatch watch;
};

/// Of a block under 1 MPa between smooth platens, from which the upper one then goes back.
std::string warning_of(const std::vector<std::string>& overrides) {
    const Model model = build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0}}
geometry: {domain: {rectangle: {width: 1, height: 1}}, reference_spacing: 1}
boundaries: {bottom: {support: pinned}}
stages:
  - {pressure: {top: 1 MPa}}
  - {strain: {boundary: top, value: -0.02 %}, steps: 20}
)",
                                                          overrides))
                            .model;
    State state = initial_state(model);
    Watching observer(model);
    const std::atomic<bool> stop{false};
    (void)run_simulation(model, {}, {}, state, observer, stop);
    return observer.watch.warning();
}

// The block is shorter by 1 MPa/10 GPa = 0.01 %, which the tenth step of the second stage passes: 0.01025 %.
TEST(PlatenWatch, SaysWhereAPlatenThatIsNotGluedLeavesTheBody) {
    EXPECT_THAT(warning_of({"stages.1.strain.value=-0.0205 %"}), HasSubstr("load step 11: the platen on 'top'"));
    EXPECT_THAT(warning_of({}), HasSubstr("stages.1.strain.glued: true"));
}

TEST(PlatenWatch, IsSilentOfPlatensThatStay) {
    EXPECT_THAT(warning_of({"stages.1.strain.glued=true"}), IsEmpty());
    EXPECT_THAT(warning_of({"stages.1.strain.value=-0.0095 %"}), IsEmpty());
    EXPECT_THAT(warning_of({"stages.1.strain.value=0.02 %"}), IsEmpty());
}

} // namespace
} // namespace kluft
