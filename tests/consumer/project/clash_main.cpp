// SPDX-License-Identifier: Apache-2.0
// A user asks what clashes in the files of an assembly: a tip in a plate, and what floats above it.
#include <raycontact/clash.h>

#include <cmath>
#include <cstdio>
#include <fstream>

int main(int, char** arguments) {
    std::ofstream(arguments[1]) << "o plate\nv -5 -5 0\nv 9 -5 0\nv -5 9 0\nv 0.5 0.5 -1\n"
                                   "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n"
                                   "o tip\nv 0 0 -0.125\nv 1 0 2\nv 0 1 2\nv -1 -1 2\n"
                                   "f 6 7 8\nf 5 7 6\nf 5 8 7\nf 5 6 8\n";
    std::ofstream(arguments[2]) << "OFF 4 4 0\n1 0 3\n0 1 3\n-1 -1 3\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    const auto parts = raycontact::load_parts({arguments[1], arguments[2]});
    raycontact::ClashOptions options;
    options.clearance = 1;
    const auto report = raycontact::find_clashes(parts, options);
    for (const auto& clash : report.clashes)
        std::printf("%s x %s: %s, depth %.4f\n", parts[clash.a].name.c_str(), parts[clash.b].name.c_str(),
                    raycontact::to_string(clash.kind), clash.depth.value_or(0));
    if (parts.size() != 3 || report.clashes.size() != 2) return 1;
    return std::fabs(*report.clashes[0].depth - 0.125) < 1e-5 && *report.clashes[1].depth == -1 ? 0 : 1;
}
