// The forces on the blocks of a kept state as tables: contacts/<step>.csv and supports/<step>.csv.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/loading/acting_forces.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

/// One row per point where blocks meet, `block_a, block_b, x, y, length, normal_x, normal_y, normal_traction, shear_traction,
/// state, law, x_b, y_b`: the current place of block a's point and of block b's (scene coordinates, m), the length that the
/// point stands for (m), the normal from a to b, the tractions (Pa; normal positive in compression, shear positive where b
/// has moved against a along the normal turned by +90 degrees), `bonded, locked, sliding` or `open`, and the name of the
/// interface. Force on a: length (-normal_traction normal + shear_traction tangent) at (x, y); on b the opposite at (x_b, y_b).
/// `law_names`: one per law. Numbers are read back exactly. Puts the table part by part: of a million blocks it has 1.2 GB.
void put_contacts_csv(const BlockSystem& system, const std::vector<ContactForce>& contacts,
                      const std::vector<std::string>& law_names, const Put& put);

/// One row per force from outside the body, `block, boundary, fx, fy, x, y, kind`: force (N per metre of thickness), its current
/// place (scene coordinates, m), and `weight, pressure, force, platen, support` or `fixed`; no boundary where it has none.
[[nodiscard]] std::string supports_csv(const BlockSystem& system, const std::vector<SupportForce>& supports);

} // namespace kluft
