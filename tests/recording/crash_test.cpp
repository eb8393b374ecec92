// SPDX-License-Identifier: Apache-2.0
// A recorder that is killed leaves every step it had flushed; a reader may look on at any moment.
#include "sample.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <array>
#include <csignal>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

/// A process that records and tells of each step it has done, until it is killed or done. It tells in records so long
/// that a pipe holds only some 16 of them: it cannot run far ahead of who listens.
class Child {
public:
    Child(const Sample& sample, const std::filesystem::path& file, bool finish) {
        int ends[2];
        if (pipe(ends) != 0) throw std::runtime_error("pipe");
        process_ = fork();
        if (process_ == 0) {
            close(ends[0]);
            work(sample, file, finish, ends[1]);
        }
        close(ends[1]);
        from_ = ends[0];
    }
    ~Child() {
        kill();
        close(from_);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Waits for one more step; false when there is none.
    bool step() const {
        Record record;
        return read(from_, record.data(), record.size()) == static_cast<ssize_t>(record.size());
    }
    void kill() {
        if (process_ <= 0) return;
        ::kill(process_, SIGKILL);
        wait();
    }
    /// The exit status.
    int wait() {
        int status = -1;
        waitpid(process_, &status, 0);
        process_ = -1;
        return status;
    }

private:
    using Record = std::array<char, 4096>; // a pipe takes and gives so many at once

    [[noreturn]] static void work(const Sample& sample, const std::filesystem::path& file, bool finish, int to) {
        try {
            Writer writer(file, sample.info, {5, 1e9, 1u << 20});
            Feeder feeder(sample, writer);
            while (feeder.steps() < sample.steps()) {
                feeder.step();
                const Record record{};
                if (write(to, record.data(), record.size()) != static_cast<ssize_t>(record.size())) _exit(3);
            }
            if (!finish) pause();
            writer.finish(sample.hash);
        } catch (const std::exception&) {
            _exit(4);
        }
        _exit(0);
    }

    pid_t process_ = -1;
    int from_ = -1;
};

} // namespace

TEST(Crash, KeepsEveryFlushedStep) {
    const Sample sample = make_sample(60);
    for (const std::uint32_t done : {1u, 4u, 6u, 23u, 41u, 60u}) {
        const TemporaryFile file;
        Child child(sample, file.path(), false);
        for (std::uint32_t i = 0; i < done; ++i) ASSERT_TRUE(child.step());
        child.kill();
        Reader reader(file.path());
        const std::uint32_t flushed = 1 + (done - 1) / 5 * 5;
        EXPECT_GE(reader.steps(), flushed); // it may have gone on before it died
        EXPECT_EQ(difference(sample, reader, reader.steps()), "");
        EXPECT_FALSE(reader.hash().has_value());
        tinygltf::TinyGLTF loader;
        tinygltf::Model model;
        std::string error, warning;
        EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, file.path().string())) << error;
    }
}

TEST(Crash, AFullDiskEndsTheRecordingAndLeavesWhatWasWritten) {
    const Sample sample = make_sample(30);
    const TemporaryFile file;
    {
        Writer writer(file.path(), sample.info, {5, 1e9, 1u << 20});
        Feeder feeder(sample, writer);
        while (feeder.steps() < 21) feeder.step();
        std::signal(SIGXFSZ, SIG_IGN);
        rlimit before{};
        ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
        rlimit full = before;
        full.rlim_cur = writer.bytes();
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
        EXPECT_THROW(while (feeder.steps() < 30) feeder.step(), std::runtime_error);
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
        EXPECT_EQ(feeder.steps(), 25u);
        // There is room again; but steps that come now would not follow on those before.
        EXPECT_THROW(feeder.step(), std::runtime_error);
        EXPECT_THROW(writer.finish(sample.hash), std::runtime_error);
    }
    Reader reader(file.path());
    EXPECT_EQ(difference(sample, reader, 21), "");
    EXPECT_FALSE(reader.hash().has_value());
}

TEST(Crash, WholeBlocksBehindTheCommittedOnesCount) {
    const Sample sample = make_sample(30);
    const TemporaryFile file;
    record(sample, file.path(), false);
    // Died between writing a block and making it part of the chunk: the lengths of an earlier moment, and a torn end.
    const TemporaryFile earlier;
    Sample shorter = sample;
    shorter.poses.resize(21);
    shorter.pairs.resize(21);
    record(shorter, earlier.path(), false);
    std::vector<unsigned char> bytes = bytes_of(file.path());
    const std::vector<unsigned char> before = bytes_of(earlier.path());
    const std::size_t side = side_chunk_at(bytes);
    ASSERT_EQ(side, side_chunk_at(before));
    std::copy_n(before.begin() + 8, 4, bytes.begin() + 8);
    std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(side), 4,
                bytes.begin() + static_cast<std::ptrdiff_t>(side));
    write_bytes(file.path(), bytes);
    Reader whole(file.path());
    EXPECT_EQ(difference(sample, whole, 30), "");
    bytes.resize(bytes.size() - 9);
    write_bytes(file.path(), bytes);
    Reader torn(file.path());
    EXPECT_EQ(difference(sample, torn, 26), "");
}

TEST(Crash, AnyMomentIsAGoodOneToLook) {
    const Sample sample = make_sample(600);
    const TemporaryFile file;
    Child child(sample, file.path(), true);
    ASSERT_TRUE(child.step());
    std::uint32_t seen = 0, looks = 0;
    bool ended = false;
    while (!ended) {
        Reader reader(file.path());
        EXPECT_GE(reader.steps(), seen);
        seen = reader.steps();
        ASSERT_EQ(difference(sample, reader, seen), "");
        ended = reader.hash().has_value();
        ++looks;
        for (int i = 0; i < 40 && child.step(); ++i) {
        }
    }
    EXPECT_EQ(seen, 600u);
    EXPECT_GT(looks, 10u);
    EXPECT_EQ(child.wait(), 0);
    Reader reader(file.path());
    EXPECT_EQ(difference(sample, reader, 600), "");
}
