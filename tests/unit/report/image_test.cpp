// SPDX-License-Identifier: Apache-2.0
#include "decode.h"

#include <gtest/gtest.h>

#include <cmath>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

namespace raycontact::report {

Image decode(const std::string& bytes) {
    int width = 0, height = 0, channels = 0;
    stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                            static_cast<int>(bytes.size()), &width, &height, &channels, 3);
    if (!pixels) {
        ADD_FAILURE() << "not a picture: " << stbi_failure_reason();
        return {};
    }
    Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    image.rgb.assign(pixels, pixels + std::size_t{3} * image.width * image.height);
    stbi_image_free(pixels);
    return image;
}

double contrast(const Image& image) {
    double sum = 0, squares = 0, count = 0;
    for (std::size_t k = 1; k < image.rgb.size(); k += 3) {
        sum += image.rgb[k];
        squares += image.rgb[k] * image.rgb[k];
        ++count;
    }
    return count > 0 ? std::sqrt(std::max(0.0, squares / count - sum * sum / count / count)) : 0;
}

namespace {

Image gradient() {
    Image image{37, 19, {}};
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x)
            for (const std::uint32_t c : {6 * x, 12 * y, 3 * x + 4 * y})
                image.rgb.push_back(static_cast<std::uint8_t>(c));
    return image;
}

TEST(Image, PngKeepsEveryPixel) {
    const Image image = gradient(), back = decode(encode_png(image));
    EXPECT_EQ(back.width, image.width);
    EXPECT_EQ(back.height, image.height);
    EXPECT_EQ(back.rgb, image.rgb);
}

TEST(Image, JpegIsClose) {
    const Image image = gradient(), back = decode(encode_jpeg(image, 95));
    ASSERT_EQ(back.rgb.size(), image.rgb.size());
    double error = 0;
    for (std::size_t k = 0; k < image.rgb.size(); ++k) error += std::abs(image.rgb[k] - back.rgb[k]);
    EXPECT_LT(error / static_cast<double>(image.rgb.size()), 4);
}

TEST(Image, Base64OfTheStandard) { // RFC 4648, section 10
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

} // namespace
} // namespace raycontact::report
