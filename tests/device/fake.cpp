// SPDX-License-Identifier: Apache-2.0
#include "device/fake.h"

namespace raycontact::device_test {

namespace {

class FakeDevice : public ForwardingDevice {
public:
    FakeDevice(std::unique_ptr<Device> inner, const std::string& id, std::shared_ptr<Script> script, bool shares_memory)
        : ForwardingDevice(std::move(inner)), script_(std::move(script)), info_(ForwardingDevice::info()),
          traits_(ForwardingDevice::traits()) {
        info_.id = id;
        traits_.shares_memory = shares_memory;
    }

    const DeviceInfo& info() const override { return info_; }
    const DeviceTraits& traits() const override { return traits_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        call("allocate", false);
        return ForwardingDevice::make_buffer(bytes);
    }

private:
    void call(std::string name, bool waits) {
        Script& s = *script_;
        const std::size_t number = s.calls.size();
        s.calls.push_back(std::move(name));
        const bool fails = s.fault == Fault::once ? number == s.at
                           : s.fault == Fault::lost
                               ? number >= s.at
                               : s.fault == Fault::watchdog && number >= s.at && (waits || s.failed > 0);
        if (!fails) return;
        ++s.failed;
        throw DeviceError(s.calls.back() + ", call " + std::to_string(number) + ": as the test wants it");
    }
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        call("write", false);
        ForwardingDevice::write(to, offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override {
        call("read", true);
        ForwardingDevice::read(pieces);
    }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override {
        call("copy", false);
        ForwardingDevice::copy(to, from, bytes);
    }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        call(std::to_string(static_cast<unsigned>(kernel)), false);
        ForwardingDevice::launch(kernel, count, arguments);
    }
    kernels::uint scan(const ScanOf& scan) override {
        call("scan", false);
        return ForwardingDevice::scan(scan);
    }
    void finish() override {
        call("finish", true);
        ForwardingDevice::finish();
    }

    std::shared_ptr<Script> script_;
    DeviceInfo info_;
    DeviceTraits traits_;
};

} // namespace

OpenDevice open_fake(const std::string& id, std::shared_ptr<Script> script, bool shares_memory) {
    OpenDevice opened = open_device("cpu", 1);
    opened.device = std::make_unique<FakeDevice>(std::move(opened.device), id, std::move(script), shares_memory);
    return opened;
}

} // namespace raycontact::device_test
