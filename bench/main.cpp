// SPDX-License-Identifier: Apache-2.0
#include "bench/commands.h"

#include <cli/program.h>

namespace {

void add_benchmarks(CLI::App& app) {
    using namespace raycontact::bench;
    for (const auto add : {add_peers, add_growth, add_device, add_queries, add_rays, add_stacks, add_holds, add_motion,
                           add_clash, add_scale, add_threads, add_new_shape, add_factory})
        add(app);
}

} // namespace

int main(int argc, char** argv) {
    const Program program{"raycontact-bench",
                          "What contacts cost: against other libraries, at other sizes, in worlds of Bullet's.\n"
                          "NAME --help lists the options of one benchmark; bench/README.md says what each measures.\n",
                          "Exit status: 0 fine, 1 a benchmark failed or found what must not be, 2 bad usage or input.",
                          add_benchmarks};
    return run_program(program, argc, argv);
}
