#include <iostream>

#include <kluft/constitutive/lattice_stiffness.hpp>
#include <kluft/core/version.hpp>

int main() {
    const auto blocks = kluft::block_moduli(10e9, 0.25, kluft::Plane::strain, 10.0, 0.5, kluft::hexagon_net(0.03));
    const auto body = kluft::lattice_moduli(blocks, {.normal = 1e11 / 0.03, .shear = 0.5e11 / 0.03},
                                            kluft::hexagon_net(0.03), kluft::Plane::strain);
    std::cout << kluft::version() << ' ' << body.youngs_modulus << '\n';
}
