#include "kluft/scene/quantity.hpp"

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(Quantity, PlainNumbersAreSiAndPlainAnglesAreDegrees) {
    EXPECT_EQ(read_quantity("9.81", Measure::acceleration).value, 9.81);
    EXPECT_EQ(read_quantity("-1e3", Measure::stress).value, -1000.0);
    EXPECT_EQ(read_quantity(".5", Measure::fraction).value, 0.5);
    EXPECT_EQ(read_quantity("+5.", Measure::fraction).value, 5.0);
    EXPECT_DOUBLE_EQ(read_quantity("30", Measure::angle).value.value(), std::numbers::pi / 6.0);
}

/// A unit is an exact power of ten: the same double as the number written out in SI.
TEST(Quantity, UnitsConvertToTheSameDoubleAsTheNumberInSi) {
    EXPECT_EQ(read_quantity("38 cm", Measure::length).value, 0.38);
    EXPECT_EQ(read_quantity("3cm", Measure::length).value, 0.03);
    EXPECT_EQ(read_quantity("0.7 mm", Measure::length).value, 0.0007);
    EXPECT_EQ(read_quantity("25 MPa", Measure::stress).value, 25e6);
    EXPECT_EQ(read_quantity("1.3 %", Measure::fraction).value, 0.013);
    EXPECT_EQ(read_quantity("1.3e+03 %", Measure::fraction).value, 13.0);
    EXPECT_EQ(read_quantity("1.3e-003 %", Measure::fraction).value, 1.3e-5);
    EXPECT_EQ(read_quantity("1E0 %", Measure::fraction).value, 0.01);
    EXPECT_EQ(read_quantity("200 MPa/m", Measure::stiffness).value, 200e6);
    EXPECT_EQ(read_quantity("2650 kg/m3", Measure::density).value, 2650.0);
    EXPECT_EQ(read_quantity("2.65 t/m^3", Measure::density).value, 2650.0);
    EXPECT_DOUBLE_EQ(read_quantity("0.5 rad", Measure::angle).value.value(), 0.5);
    EXPECT_DOUBLE_EQ(read_quantity("180 deg", Measure::angle).value.value(), std::numbers::pi);
    EXPECT_DOUBLE_EQ(read_quantity("180°", Measure::angle).value.value(), std::numbers::pi);
}

TEST(Quantity, UnitsCombineWithPowersProductsAndQuotients) {
    EXPECT_DOUBLE_EQ(read_quantity("2 N/mm2", Measure::stress).value.value(), 2e6);
    EXPECT_DOUBLE_EQ(read_quantity("3 N mm-2", Measure::stress).value.value(), 3e6);
    EXPECT_DOUBLE_EQ(read_quantity("1 kN/m3", Measure::stiffness).value.value(), 1000.0); // N/m3 = Pa/m
    EXPECT_DOUBLE_EQ(read_quantity("2 g/cm3", Measure::density).value.value(), 2000.0);
    EXPECT_DOUBLE_EQ(read_quantity("981 cm/s^2", Measure::acceleration).value.value(), 9.81);
    EXPECT_DOUBLE_EQ(read_quantity("4 mm/m", Measure::fraction).value.value(), 0.004);
    EXPECT_DOUBLE_EQ(read_quantity("2 m*kg/m4", Measure::density).value.value(), 2.0);
}

TEST(Quantity, RefusesAnotherDimensionAndNamesIt) {
    EXPECT_EQ(read_quantity("25 m", Measure::stress).problem, ", which is in m");
    EXPECT_EQ(read_quantity("25 MPa", Measure::stiffness).problem, ", which is in Pa");
    EXPECT_EQ(read_quantity("3 %", Measure::length).problem, ", which is in no unit but a plain number");
    EXPECT_EQ(read_quantity("3 kg", Measure::length).problem, ", which is in kg");
    EXPECT_EQ(read_quantity("3 m2/s", Measure::length).problem, ", which is in m2 s-1");
}

TEST(Quantity, RefusesUnknownUnitsAndNamesTheNearest) {
    EXPECT_EQ(read_quantity("3 Mpaa", Measure::stress).problem, " with the unknown unit 'Mpaa'; did you mean 'MPa'?");
    for (const char* text : {"3 /", "3 m/", "3 //m", "3 m0", "3 m^", "3 m12", "3 m2x", "3 ^2", "3 *m", "3 -", "3 --2"})
        EXPECT_FALSE(read_quantity(text, Measure::length).value) << text;
}

TEST(Quantity, RefusesWhatIsNoDecimalNumber) {
    for (const char* text : {"",    " ",   "-",    "+",     ".",   "e5",    "0x10",   "012", "-012", "1_000",
                             "1,5", "nan", ".nan", "-.inf", "inf", "1e999", "1e-999", "MPa", "--1",  "1.2.3"})
        for (const Measure measure : {Measure::fraction, Measure::stress})
            EXPECT_FALSE(read_quantity(text, measure).value) << text;
    EXPECT_EQ(read_quantity(".nan", Measure::stress).problem, ", which is not finite");
    EXPECT_EQ(read_quantity("012", Measure::stress).problem, ", which has a leading zero");
    EXPECT_EQ(read_quantity("1e999", Measure::stress).problem, ", which is beyond the range of a number");
    EXPECT_EQ(read_quantity("1e308 GPa", Measure::stress).problem, ", which is beyond the range of a number");
}

TEST(Integer, TakesPlainDecimalIntegersOnly) {
    EXPECT_EQ(read_integer("0"), 0);
    EXPECT_EQ(read_integer("-7"), -7);
    EXPECT_EQ(read_integer("+7"), 7);
    EXPECT_EQ(read_integer("9007199254740992"), 9007199254740992LL);
    for (const char* text : {"", "-", "07", "1.0", "1e3", "9007199254740993", "99999999999999999999", "0x1", "1 "})
        EXPECT_FALSE(read_integer(text)) << text;
}

} // namespace
} // namespace kluft
