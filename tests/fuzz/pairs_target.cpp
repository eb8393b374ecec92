// SPDX-License-Identifier: Apache-2.0
// A pairs file, as `raycontact collide --pairs` reads it.
#include "cli/pairs_file.h"
#include "fuzz/input.h"
#include "temporary_folder.h"

#include <raycontact/scene.h>

#include <cmath>

using namespace raycontact;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TemporaryFolder folder;
    const auto file = folder.write("pairs.json", fuzz::text_of({data, size}));
    fuzz::taken([&] {
        for (const QueryPair& pair : read_pairs_file(file)) {
            for (const PairBody& body : pair) {
                check_pose(body.pose, "a pair"); // what was read is fit for a scene
                if (!(body.scale > 0) || !std::isfinite(body.scale)) fuzz::fail("a scale that is none");
                if (body.file.native().find('\0') != std::string::npos) fuzz::fail("a name with a zero byte");
            }
        }
    });
    return 0;
}
