// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"

#include <raycontact/contact.h>
#include <raycontact/contact_columns.h>

#include <span>
#include <vector>

namespace raycontact {

/// Writes columns of contacts to the caller's memory.
class ContactColumnWriter {
public:
    /// Returns when all are there. Throws InputError before it writes any, where one has too little room.
    void run(Executor& executor, std::span<const Contact> contacts, std::span<const ContactOutput> outputs);

private:
    std::vector<std::vector<std::byte>> columns_;
};

} // namespace raycontact
