// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Of the program. `found`: a check that was asked for found something; nothing went wrong.
enum ExitStatus : int { fine = 0, failed = 1, bad_input = 2, found = 3 };

/// Thrown by a subcommand that has said all there is to say.
struct EndWith {
    ExitStatus status;
};
