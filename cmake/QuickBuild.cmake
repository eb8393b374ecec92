# SPDX-License-Identifier: Apache-2.0
# What makes a first build short, for scripts/test core: what the headers of the standard library and of GoogleTest cost
# is paid once for each of the large targets. No other build relies on it, so files include what they use.
option(RAYCONTACT_QUICK_BUILD "Precompile headers (scripts/test core)" OFF)

# raycontact_share_headers(TARGET HEADER...)
function(raycontact_share_headers target)
    if(RAYCONTACT_QUICK_BUILD)
        target_precompile_headers(${target} PRIVATE <algorithm> <array> <atomic> <charconv> <cmath> <cstdint> <filesystem>
            <fstream> <functional> <limits> <map> <memory> <numeric> <optional> <set> <span> <sstream> <stop_token> <string> <thread>
            <unordered_map> <utility> <vector> ${ARGN})
    endif()
endfunction()
