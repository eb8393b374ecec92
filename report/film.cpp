// SPDX-License-Identifier: Apache-2.0
#include <report/film.h>

#include <webp/encode.h>
#include <webp/mux.h>

#include <memory>
#include <stdexcept>

namespace raycontact::report {
namespace {

constexpr float quality = 62;
constexpr int effort = 2; // of 0 to 6: a frame takes some milliseconds

struct Picture : WebPPicture {
    Picture() : WebPPicture() {
        if (WebPPictureInit(this) == 0)
            throw std::runtime_error("film: libwebp is of another version than its headers");
    }
    ~Picture() { WebPPictureFree(this); }
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;
};

} // namespace

std::string encode_webp(const std::vector<Image>& frames, int milliseconds_a_frame) {
    if (frames.empty()) throw std::runtime_error("film: there are no frames");
    WebPAnimEncoderOptions options;
    if (WebPAnimEncoderOptionsInit(&options) == 0) throw std::runtime_error("film: libwebp's options cannot be set");
    const auto width = static_cast<int>(frames.front().width), height = static_cast<int>(frames.front().height);
    const std::unique_ptr<WebPAnimEncoder, void (*)(WebPAnimEncoder*)> encoder(
        WebPAnimEncoderNew(width, height, &options), WebPAnimEncoderDelete);
    WebPConfig config;
    if (!encoder || WebPConfigInit(&config) == 0) throw std::runtime_error("film: libwebp does not start");
    config.quality = quality;
    config.method = effort;
    int time = 0;
    const auto add = [&](WebPPicture* picture) {
        if (WebPAnimEncoderAdd(encoder.get(), picture, time, &config) == 0)
            throw std::runtime_error(std::string("film: ") + WebPAnimEncoderGetError(encoder.get()));
        time += milliseconds_a_frame;
    };
    for (const Image& image : frames) {
        Picture picture;
        picture.use_argb = 1;
        picture.width = width;
        picture.height = height;
        if (WebPPictureImportRGB(&picture, image.rgb.data(), 3 * width) == 0)
            throw std::runtime_error("film: not enough memory for a frame");
        add(&picture);
    }
    add(nullptr); // how long the last one stays
    WebPData data;
    WebPDataInit(&data);
    const bool made = WebPAnimEncoderAssemble(encoder.get(), &data) != 0;
    std::string bytes(reinterpret_cast<const char*>(data.bytes), data.size);
    WebPDataClear(&data);
    if (!made) throw std::runtime_error(std::string("film: ") + WebPAnimEncoderGetError(encoder.get()));
    return bytes;
}

} // namespace raycontact::report
