#include "kluft/simulation/event_search.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace kluft {
namespace {

/// In place of an equilibrium: a load factor, and whether something was found there.
struct Point {
    double load_factor = 0.0;
    bool balanced = true;
};

constexpr EventGoal accurate{.last_without = 1.001, .index = 1.0, .reach = 1e-3, .least_width = 1e-9};

/// The event of an index f(load factor) on [0, 1].
template <class Index> EventCut<Point> event_of(const EventGoal& goal, Index index, int* n_trials = nullptr) {
    return first_event(
        goal, 0.0, Point{1.0}, [&](const Point& at) { return index(at.load_factor); }, [&] { return index(0.0); },
        [&](double load_factor, double, const Point&) {
            if (n_trials != nullptr) ++*n_trials;
            return Point{load_factor};
        });
}

TEST(EventSearch, FindsWhereALinearIndexReachesOneInOneTrial) {
    int n_trials = 0;
    const auto cut = event_of(
        accurate, [](double x) { return 4.0 * x; }, &n_trials);
    EXPECT_NEAR(cut.found.load_factor, 0.25, 1e-3 / 4.0);
    EXPECT_EQ(n_trials, 1);
}

// f = 0.1 x up to a kink at 0.9, then steep: f(0.9) = 0.09, f(1) = 5.09; one at 0.9 + 0.91/50.
TEST(EventSearch, FindsAnEventBehindAKink) {
    const auto cut = event_of(accurate, [](double x) { return x < 0.9 ? 0.1 * x : 0.09 + 50.0 * (x - 0.9); });
    EXPECT_NEAR(cut.found.load_factor, 0.9 + 0.91 / 50.0, 1e-3 / 50.0);
}

TEST(EventSearch, EndsAtTheEndWhereTheIndexStaysBelowOne) {
    int n_trials = 0;
    const auto cut = event_of(
        accurate, [](double x) { return 0.99 * x; }, &n_trials);
    EXPECT_EQ(cut.found.load_factor, 1.0);
    EXPECT_EQ(n_trials, 0);
}

TEST(EventSearch, EnclosesAJumpByTheLeastWidth) {
    const EventGoal goal{.last_without = 1.001, .index = 1.0, .reach = 1e-3, .least_width = 1e-4};
    const auto cut = event_of(goal, [](double x) { return x < 0.3 ? 0.5 : 2.0; });
    EXPECT_GE(cut.found.load_factor, 0.3);
    EXPECT_LE(cut.found.load_factor, 0.3 + 1e-4);
    EXPECT_LE(cut.width, 1e-4);
}

// f = 4 x reaches one at 0.25, and between 0.4 and 1 nothing is found: the end, where f is 4, is not taken for the event.
TEST(EventSearch, GoesOnAtSmallerLoadsWhereNothingIsFoundInBetween) {
    const auto cut = first_event(
        accurate, 0.0, Point{1.0}, [](const Point& at) { return std::min(2.0, 4.0 * at.load_factor); },
        [] { return 0.0; },
        [](double load_factor, double, const Point&) {
            return Point{load_factor, load_factor < 0.4};
        });
    EXPECT_NEAR(cut.found.load_factor, 0.25, 1e-3 / 4.0);
}

// f = 2 x reaches one at 0.5, where nothing is found from 0.45 on: the load step ends before it.
TEST(EventSearch, EndsBeforeAnEventThatLiesWhereNothingIsFound) {
    const auto cut = first_event(
        accurate, 0.0, Point{1.0}, [](const Point& at) { return 2.0 * at.load_factor; }, [] { return 0.0; },
        [](double load_factor, double, const Point&) {
            return Point{load_factor, load_factor < 0.45};
        });
    EXPECT_LT(cut.found.load_factor, 0.45);
    EXPECT_GT(cut.found.load_factor, 0.2);
    EXPECT_TRUE(cut.found.balanced);
}

TEST(EventSearch, KeepsTheLastEventKnownWhereNothingIsFoundInBetween) {
    const auto cut = first_event(
        accurate, 0.0, Point{1.0}, [](const Point& at) { return 4.0 * at.load_factor * at.load_factor; },
        [] { return 0.0; },
        [](double load_factor, double, const Point&) {
            return Point{load_factor, load_factor > 0.6};
        });
    EXPECT_TRUE(cut.found.balanced);
    EXPECT_EQ(cut.found.load_factor, 1.0);
    EXPECT_EQ(cut.width, 1.0); // that is all that is known of where it was
}

// The guess for a trial lies on the line from the start to the end that is known.
TEST(EventSearch, GivesEachTrialItsShareOfTheWay) {
    int n_trials = 0;
    (void)first_event(
        accurate, 0.5, Point{1.0}, [](const Point& at) { return 8.0 * (at.load_factor - 0.5); }, [] { return 0.0; },
        [&](double load_factor, double share, const Point& end) {
            ++n_trials;
            EXPECT_NEAR(share, (load_factor - 0.5) / (end.load_factor - 0.5), 1e-15);
            return Point{load_factor};
        });
    EXPECT_GT(n_trials, 0);
}

TEST(EventSearch, ExpectsTheEventOfASmoothIndexWhereItIs) {
    EXPECT_NEAR(expected_event(1e-3, [](double x) { return 3.0 * x * x; }), std::sqrt(1.0 / 3.0), 1e-3);
    EXPECT_EQ(expected_event(1e-3, [](double x) { return 0.5 * x; }), 1.0);
    EXPECT_EQ(expected_event(1e-3, [](double x) { return 1.5 + x; }), 1.0); // it is there already
}

} // namespace
} // namespace kluft
