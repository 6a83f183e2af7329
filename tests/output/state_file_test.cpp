#include "kluft/output/state_file.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

State state_of(int n_blocks) {
    State state;
    state.at.stage = 1;
    state.at.step_in_stage = 4;
    state.at.step = 24;
    state.at.load_factor = 0.1;
    state.body.displacement = Eigen::VectorXd::LinSpaced(6 * n_blocks, -1.0 / 3.0, std::numeric_limits<double>::min());
    state.stage_start.displacement = 0.5 * state.body.displacement;
    state.strain_zero = 0.25 * state.body.displacement;
    state.body.interfaces = {InterfaceStatus::potential_crack, InterfaceStatus::fracture,
                             InterfaceStatus::tension_crack, InterfaceStatus::shear_crack};
    state.body.bond_shear = {1.0, -2.0, 3.0, 0.1};
    state.body.contacts = {{{0, 1, 2, 3, -1}, {1.25e5, 1e-7}}, {{4, 5, 6, 7, 2}, {-0.1, 0.0}}};
    state.body.holding_forces = {3e5, 0.0, -1.0 / 7.0};
    state.stage_start.boundary_pressure = {2e5, 0.0, 1.0 / 7.0};
    state.unbalanced_in_succession = 2;
    state.imbalance = {1, 0.25, {{1, Vec2(0.6, -0.8), 0}, {0, Vec2::Zero(), -1}}};
    state.jumps = 3;
    state.remarks = {{1.0 / 3.0, 9}, {"load step 9: a contact was lost", "", "\xc3\xa4"}};
    state.memory.rate = 3.0 * state.body.displacement;
    state.memory.near_pairs = {{0, 3}, {2, 1}};
    ContactPoint kept{.block_a = 3, .block_b = 2, .weight = 0.3, .along = 0.7, .law = 1, .interface = 4};
    kept.xi_b = {0.1, -0.2};
    kept.normal = {0.6, 0.8};
    kept.piece = {{1, 2}, {3, 4}, {5, 6}, 7, 8};
    kept.key = {1, 2, 3, 4, 5};
    state.memory.kept_points = {kept};
    state.memory.steps_since_detection = 2;
    state.memory.detected_at = 0.5 * state.body.displacement;
    state.control = {0.01, 0.02, 2e-4, 0.5, 1e-3, 2e-3, 3e-3, 2, {2, 0}};
    state.stresses = {1.2e6, 1.5e6, 1e6, 1, 1.4e6};
    state.is_settled = false;
    state.costs = {179, 180, 2, 150, 40, 2000, 3, 5, 4, 12.5, 11.5, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
    return state;
}

void expect_same(const State& a, const State& b) {
    EXPECT_EQ(a.at.stage, b.at.stage);
    EXPECT_EQ(a.at.step_in_stage, b.at.step_in_stage);
    EXPECT_EQ(a.at.step, b.at.step);
    EXPECT_EQ(a.at.load_factor, b.at.load_factor);
    EXPECT_EQ(a.body.displacement, b.body.displacement);
    EXPECT_EQ(a.stage_start.displacement, b.stage_start.displacement);
    EXPECT_EQ(a.strain_zero, b.strain_zero);
    EXPECT_EQ(a.memory.rate, b.memory.rate);
    EXPECT_EQ(a.body.interfaces, b.body.interfaces);
    EXPECT_EQ(a.body.bond_shear, b.body.bond_shear);
    ASSERT_EQ(a.body.contacts.size(), b.body.contacts.size());
    for (std::size_t i = 0; i < a.body.contacts.size(); ++i) {
        EXPECT_EQ(a.body.contacts[i].key, b.body.contacts[i].key);
        EXPECT_EQ(a.body.contacts[i].history.shear_trial, b.body.contacts[i].history.shear_trial);
        EXPECT_EQ(a.body.contacts[i].history.dilation, b.body.contacts[i].history.dilation);
    }
    EXPECT_EQ(a.body.holding_forces, b.body.holding_forces);
    EXPECT_EQ(a.stage_start.boundary_pressure, b.stage_start.boundary_pressure);
    EXPECT_EQ(a.is_settled, b.is_settled);
    EXPECT_EQ(a.stresses, b.stresses);
    EXPECT_EQ(a.unbalanced_in_succession, b.unbalanced_in_succession);
    EXPECT_EQ(a.imbalance, b.imbalance);
    EXPECT_EQ(a.jumps, b.jumps);
    EXPECT_EQ(a.remarks, b.remarks);
    EXPECT_EQ(a.memory.rate, b.memory.rate);
    EXPECT_EQ(a.memory.near_pairs, b.memory.near_pairs);
    EXPECT_EQ(a.memory.steps_since_detection, b.memory.steps_since_detection);
    EXPECT_EQ(a.memory.detected_at, b.memory.detected_at);
    ASSERT_EQ(a.memory.kept_points.size(), b.memory.kept_points.size());
    for (std::size_t i = 0; i < a.memory.kept_points.size(); ++i) {
        const ContactPoint& p = a.memory.kept_points[i];
        const ContactPoint& r = b.memory.kept_points[i];
        EXPECT_EQ(std::tie(p.block_a, p.block_b, p.weight, p.along, p.law, p.interface, p.xi_a, p.xi_b, p.offset,
                           p.normal, p.tangent, p.piece.xi_a, p.piece.xi_b, p.piece.offset, p.piece.from, p.piece.to),
                  std::tie(r.block_a, r.block_b, r.weight, r.along, r.law, r.interface, r.xi_a, r.xi_b, r.offset,
                           r.normal, r.tangent, r.piece.xi_a, r.piece.xi_b, r.piece.offset, r.piece.from, r.piece.to));
        EXPECT_EQ(p.key, r.key);
    }
    EXPECT_EQ(a.costs.open_close_iterations, b.costs.open_close_iterations);
    EXPECT_EQ(a.costs.factorizations, b.costs.factorizations);
    EXPECT_EQ(a.costs.analyses, b.costs.analyses);
    EXPECT_EQ(a.costs.updates, b.costs.updates);
    EXPECT_EQ(a.costs.largest_rank, b.costs.largest_rank);
    EXPECT_EQ(a.costs.refinements, b.costs.refinements);
    EXPECT_EQ(a.costs.relaxations, b.costs.relaxations);
    EXPECT_EQ(a.costs.events, b.costs.events);
    EXPECT_EQ(a.costs.rejected_steps, b.costs.rejected_steps);
    EXPECT_EQ(a.control, b.control);
    EXPECT_EQ(a.costs.elapsed_s, b.costs.elapsed_s);
    EXPECT_EQ(a.costs.loading_cpu_s, b.costs.loading_cpu_s);
    EXPECT_EQ(a.costs.seconds.detection, b.costs.seconds.detection);
    EXPECT_EQ(a.costs.seconds.observers, b.costs.seconds.observers);
}

// Each array of numbers in its turn, at its end.
TEST(StateFile, ANumberThatIsNoneIsRefusedAndTheStateSavedBeforeStays) {
    const TemporaryDirectory directory;
    const State good = state_of(3);
    write_state(directory / "state.h5", good, "scene 1");
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::function<void(State&)>> plants{
        [](State& state) { state.body.displacement[17] = none; },
        [](State& state) { state.stage_start.displacement[17] = none; },
        [](State& state) { state.strain_zero[0] = none; },
        [](State& state) { state.memory.rate[3] = none; },
        [](State& state) { state.body.bond_shear.back() = none; },
        [](State& state) { state.body.contacts[1].history.shear_trial = none; },
        [](State& state) { state.body.contacts[0].history.dilation = none; },
        [](State& state) { state.body.holding_forces[0] = none; },
        [](State& state) { state.stage_start.boundary_pressure[2] = none; },
        [](State& state) { state.at.load_factor = none; }};
    for (const auto& plant : plants) {
        State state = good;
        plant(state);
        EXPECT_THROW(write_state(directory / "state.h5", state, "scene 1"), NoEquilibriumError);
        expect_same(read_state(directory / "state.h5", "scene 1"), good);
    }
}

TEST(StateFile, IsReadBackBitForBit) {
    const TemporaryDirectory directory;
    for (const int n_blocks : {1, 3, 30000}) {
        const State state = state_of(n_blocks);
        write_state(directory / "state.h5", state, "scene 1");
        expect_same(read_state(directory / "state.h5", "scene 1"), state);
    }
}

TEST(StateFile, CarriesTheTextOfItsScene) {
    const TemporaryDirectory directory;
    const std::string text = "kluft: 1\ntitle: \"Kl\u00fcfte\"\n" + std::string(100000, '#') + "\n";
    write_state(directory / "state.h5", state_of(2), "scene 1", text);
    EXPECT_EQ(read_state_scene(directory / "state.h5"), text);
    EXPECT_EQ(read_state_tables(directory / "state.h5"), "");
    write_state(directory / "state.h5", state_of(2), "scene 1", text, "history.csv 12");
    EXPECT_EQ(read_state_tables(directory / "state.h5"), "history.csv 12");
    write_state(directory / "state.h5", state_of(2), "scene 1");
    EXPECT_EQ(read_state_scene(directory / "state.h5"), "");
    EXPECT_THROW((void)read_state_scene(directory / "absent.h5"), InputError);
}

TEST(StateFile, HoldsAStateWithoutBlocksOrContacts) {
    const TemporaryDirectory directory;
    write_state(directory / "state.h5", State{}, "");
    expect_same(read_state(directory / "state.h5", ""), State{});
}

TEST(StateFile, IsRefusedForAnotherScene) {
    const TemporaryDirectory directory;
    write_state(directory / "state.h5", state_of(2), "scene 1");
    EXPECT_THAT([&] { (void)read_state(directory / "state.h5", "scene 2"); },
                ThrowsMessage<InputError>(HasSubstr("another scene")));
}

TEST(StateFile, IsRefusedWhenTruncatedAnywhere) {
    const TemporaryDirectory directory;
    write_state(directory / "state.h5", state_of(40), "scene");
    const std::string whole = read_file(directory / "state.h5");
    for (int part = 0; part < 20; ++part) {
        write_file(directory / "state.h5", whole.substr(0, whole.size() * static_cast<std::size_t>(part) / 20));
        EXPECT_THROW((void)read_state(directory / "state.h5", "scene"), InputError) << part;
    }
    write_file(directory / "state.h5", whole.substr(0, whole.size() - 1));
    EXPECT_THROW((void)read_state(directory / "state.h5", "scene"), InputError);
}

// The bytes of a known number are looked up in the file and one bit of them is turned.
TEST(StateFile, IsRefusedWhenABitOfTheNumbersIsWrong) {
    const TemporaryDirectory directory;
    State state = state_of(2);
    state.body.displacement[5] = 1.2345678901234567e-3;
    write_state(directory / "state.h5", state, "scene");
    std::string bytes = read_file(directory / "state.h5");
    const std::string pattern(reinterpret_cast<const char*>(&state.body.displacement[5]), sizeof(double));
    const std::size_t at = bytes.find(pattern);
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    write_file(directory / "state.h5", bytes);
    EXPECT_THAT([&] { (void)read_state(directory / "state.h5", "scene"); },
                ThrowsMessage<InputError>(HasSubstr("changed since it was saved")));
}

// Anywhere: HDF5's own numbers are in it, some of which end a program when they are wrong.
TEST(StateFile, IsRefusedWhenAnyByteIsAnother) {
    const TemporaryDirectory directory;
    write_state(directory / "state.h5", state_of(2), "scene");
    const std::string whole = read_file(directory / "state.h5");
    for (std::size_t at = 0; at < whole.size(); at += 97) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x20);
        write_file(directory / "state.h5", bytes);
        EXPECT_THROW((void)read_state(directory / "state.h5", "scene"), InputError) << at;
    }
}

// The extent of an array of 7919 numbers is looked up in the file and made larger than the file, or than any memory.
TEST(StateFile, IsRefusedWhenItClaimsToHoldMoreThanItsBytes) {
    const TemporaryDirectory directory;
    State state = state_of(2);
    state.body.bond_shear.assign(7919, 1.0);
    write_state(directory / "state.h5", state, "scene");
    const std::string file = read_file(directory / "state.h5");
    const std::string whole = file.substr(0, file.rfind("\nkluft digest "));
    const auto bytes_of = [](std::uint64_t extent) {
        return std::string(reinterpret_cast<const char*>(&extent), sizeof extent);
    };
    for (const std::uint64_t extent : {std::uint64_t{1} << 20U, std::uint64_t{1} << 33U, std::uint64_t{1} << 61U}) {
        std::string bytes = whole;
        std::size_t n_found = 0;
        for (std::size_t at = bytes.find(bytes_of(7919)); at != std::string::npos; at = bytes.find(bytes_of(7919)))
            n_found += bytes.replace(at, sizeof extent, bytes_of(extent)).empty() ? 0 : 1;
        ASSERT_GT(n_found, 0U);
        write_file(directory / "state.h5", sealed(bytes));
        EXPECT_THAT([&] { (void)read_state(directory / "state.h5", "scene"); },
                    ThrowsMessage<InputError>(HasSubstr("larger than the file")));
    }
}

TEST(StateFile, IsRefusedWhenItIsSomethingElse) {
    const TemporaryDirectory directory;
    write_file(directory / "state.h5", "step,stage\n0,0\n");
    EXPECT_THAT([&] { (void)read_state(directory / "state.h5", "scene"); },
                ThrowsMessage<InputError>(HasSubstr("damaged or foreign")));
    EXPECT_THROW((void)read_state(directory / "absent.h5", "scene"), InputError);
}

TEST(StateFile, NamesTheFileWhenTheDiskIsFull) {
    EXPECT_THAT([] { write_state("/dev/full", State{}, "scene"); },
                ThrowsMessage<ResourceError>(HasSubstr("/dev/full: cannot write: No space left")));
}

} // namespace
} // namespace kluft
