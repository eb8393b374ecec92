// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <clash/parts.h>

#include <raycontact/contact.h>

#include <vector>

namespace raycontact::clash {

/// As parts of the smaller size: depths up to noise are made by rounding, where faces coincide. Those up to shallow may
/// be, where a part ends among coinciding faces.
constexpr double noise = 1e-6, shallow = 2e-3;

/// Where faces of two parts coincide, contacts say little of a depth: a bolt that fits its hole exactly and a part that
/// another fills look alike. So one is nudged by 2 noise, four ways. Returns the contacts of the nudge that leaves the
/// least depth, if that is far more than the nudge and than the depth without; else none.
std::vector<Contact> contacts_when_nudged(const Part& a, const Part& b, double depth);

} // namespace raycontact::clash
