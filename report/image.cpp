// SPDX-License-Identifier: Apache-2.0
#include <report/image.h>

#include <webp/encode.h>
#include <webp/mux.h>

#include <memory>
#include <stdexcept>

// Private to this file: another library may carry its own stb.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace raycontact::report {
namespace {

void append(void* text, void* data, int size) {
    static_cast<std::string*>(text)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

constexpr float film_quality = 62;
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

std::string encode_png(const Image& image) {
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_png_to_func(append, &bytes, width, height, 3, image.rgb.data(), 3 * width))
        throw std::runtime_error("a picture could not be written as PNG");
    return bytes;
}

std::string encode_jpeg(const Image& image, int quality) {
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_jpg_to_func(append, &bytes, width, height, 3, image.rgb.data(), quality))
        throw std::runtime_error("a picture could not be written as JPEG");
    return bytes;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        std::uint32_t word = 0;
        for (std::size_t i = 0; i < 3; ++i)
            word = word << 8 | (k + i < bytes.size() ? static_cast<std::uint8_t>(bytes[k + i]) : 0u);
        for (std::size_t i = 0; i < 4; ++i) text += k + i <= bytes.size() ? digits[word >> (18 - 6 * i) & 63u] : '=';
    }
    return text;
}

std::string encode_webp(const std::vector<Image>& frames, int milliseconds_a_frame) {
    if (frames.empty()) throw std::runtime_error("film: there are no frames");
    WebPAnimEncoderOptions options;
    if (WebPAnimEncoderOptionsInit(&options) == 0) throw std::runtime_error("film: libwebp's options cannot be set");
    const auto width = static_cast<int>(frames.front().width), height = static_cast<int>(frames.front().height);
    const std::unique_ptr<WebPAnimEncoder, void (*)(WebPAnimEncoder*)> encoder(
        WebPAnimEncoderNew(width, height, &options), WebPAnimEncoderDelete);
    WebPConfig config;
    if (!encoder || WebPConfigInit(&config) == 0) throw std::runtime_error("film: libwebp does not start");
    config.quality = film_quality;
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
