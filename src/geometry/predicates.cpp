#include "kluft/geometry/predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kluft {

namespace {

/// An exact sum of doubles, kept as components of which none shares a bit with another (Shewchuk 1997, Theorem 10).
class Expansion {
public:
    void add(double value) {
        int kept = 0;
        for (int i = 0; i < size_; ++i) {
            const double sum = value + components_[i];
            const double part = sum - value;
            const double error = (value - (sum - part)) + (components_[i] - part);
            if (error != 0.0) components_[kept++] = error;
            value = sum;
        }
        if (value != 0.0) components_[kept++] = value;
        size_ = kept;
    }

    void add_product(double x, double y) {
        const double product = x * y;
        add(std::fma(x, y, -product));
        add(product);
    }

    /// The largest component decides.
    [[nodiscard]] int sign() const {
        if (size_ == 0) return 0;
        return components_[size_ - 1] > 0.0 ? 1 : -1;
    }

private:
    std::array<double, 16> components_{};
    int size_ = 0;
};

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    Expansion sum;
    sum.add_product(a.x(), b.y());
    sum.add_product(-a.y(), b.x());
    sum.add_product(b.x(), c.y());
    sum.add_product(-b.y(), c.x());
    sum.add_product(c.x(), a.y());
    sum.add_product(-c.y(), a.x());
    return sum.sign();
}

bool inside_box(const Vec2& p, const Vec2& a, const Vec2& b) {
    return std::min(a.x(), b.x()) <= p.x() && p.x() <= std::max(a.x(), b.x()) && std::min(a.y(), b.y()) <= p.y() &&
           p.y() <= std::max(a.y(), b.y());
}

bool boxes_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    return std::max(a.x(), b.x()) >= std::min(c.x(), d.x()) && std::max(c.x(), d.x()) >= std::min(a.x(), b.x()) &&
           std::max(a.y(), b.y()) >= std::min(c.y(), d.y()) && std::max(c.y(), d.y()) >= std::min(a.y(), b.y());
}

} // namespace

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    constexpr double filter = 4.0e-16; // above 3.33e-16, the bound (3 + 16 eps) eps on the relative error, eps = 2^-53
    const double left = (a.x() - c.x()) * (b.y() - c.y());
    const double right = (a.y() - c.y()) * (b.x() - c.x());
    const double difference = left - right;
    if (std::abs(difference) > filter * (std::abs(left) + std::abs(right))) return difference > 0.0 ? 1 : -1;
    return exact_orientation(a, b, c);
}

bool on_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    return inside_box(p, a, b) && orientation(a, b, p) == 0;
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    if (!boxes_meet(a, b, c, d)) return false;
    const int side_c = orientation(a, b, c);
    const int side_d = orientation(a, b, d);
    if (side_c * side_d > 0) return false;
    const int side_a = orientation(c, d, a);
    const int side_b = orientation(c, d, b);
    if (side_a * side_b > 0) return false;
    if (side_c == 0 && side_d == 0) {
        return inside_box(c, a, b) || inside_box(d, a, b) || inside_box(a, c, d) || inside_box(b, c, d);
    }
    return true;
}

Vec2 nearest_point(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 along = b - a;
    const double length_squared = along.squaredNorm();
    if (length_squared == 0.0) return a;
    return a + std::clamp((p - a).dot(along) / length_squared, 0.0, 1.0) * along;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 along = b - a;
    const double length_squared = along.squaredNorm();
    if (length_squared == 0.0) return (p - a).norm();
    const double position = std::clamp((p - a).dot(along) / length_squared, 0.0, 1.0);
    return (p - a - position * along).norm();
}

} // namespace kluft
