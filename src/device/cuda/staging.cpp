// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/staging.h"

#include <cstring>

namespace raycontact::cuda {

namespace {

// Whether the next piece still has room, and if so, where it begins; takes the room.
bool take_room(const Piece& piece, std::size_t& used, std::size_t room, std::size_t& at) {
    if (piece.bytes > room - used) return false;
    at = used;
    used += piece.bytes;
    return true;
}

} // namespace

Staging::Staging(std::shared_ptr<const Context> context)
    : context_(std::move(context)), up_(make_host_memory(context_, parts_.size() * part_bytes)),
      down_(make_host_memory(context_, down_bytes)) {
    for (Part& part : parts_) part.copied = make_event(context_, false);
}

std::byte* Staging::place_up(std::size_t bytes) {
    if (bytes > part_bytes - filled_) {
        Part& full = parts_[part_];
        check(driver().cuEventRecord(full.copied.get(), context_->stream()), "cuEventRecord");
        full.in_use = true;
        part_ = (part_ + 1) % parts_.size();
        filled_ = 0;
        Part& next = parts_[part_];
        if (next.in_use) check(driver().cuEventSynchronize(next.copied.get()), "cuEventSynchronize");
        next.in_use = false;
    }
    std::byte* place = static_cast<std::byte*>(up_.get()) + part_ * part_bytes + filled_;
    filled_ += bytes;
    return place;
}

void Staging::write(Address to, const void* from, std::size_t bytes) {
    if (bytes == 0) return;
    const bool direct = bytes > part_bytes;
    if (!direct) from = std::memcpy(place_up(bytes), from, bytes);
    check(driver().cuMemcpyHtoDAsync(to, from, bytes, context_->stream()), "cuMemcpyHtoDAsync");
    if (direct) check(driver().cuStreamSynchronize(context_->stream()), "cuStreamSynchronize");
}

void Staging::start(std::span<const Piece> pieces) {
    std::size_t used = 0, at = 0;
    for (const Piece& piece : pieces) {
        if (piece.bytes == 0) continue;
        const bool here = take_room(piece, used, down_bytes, at);
        check(driver().cuMemcpyDtoHAsync(here ? static_cast<std::byte*>(down_.get()) + at : piece.to,
                                         address_of(piece.from) + piece.offset, piece.bytes, context_->stream()),
              "cuMemcpyDtoHAsync");
    }
}

void Staging::bring(std::span<const Piece> pieces) {
    std::size_t used = 0, at = 0;
    for (const Piece& piece : pieces)
        if (piece.bytes > 0 && take_room(piece, used, down_bytes, at))
            std::memcpy(piece.to, static_cast<const std::byte*>(down_.get()) + at, piece.bytes);
}

void Staging::all_copied() {
    for (Part& part : parts_) part.in_use = false;
    filled_ = 0;
}

} // namespace raycontact::cuda
