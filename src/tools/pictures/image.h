// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PICTURES_IMAGE_H
#define FCL_CCD_PICTURES_IMAGE_H

#include <cassert>
#include <cstdint>
#include <string>
#include <vector>

#include "fcl/common/types.h"

namespace fcl_ccd {
namespace picture {

/// @brief Red, green, blue in [0, 1], proportional to light (not sRGB).
using Colour = fcl::Vector3<float>;

/// @brief A picture, stored row by row from the top left.
struct Image {
  int width{0};
  int height{0};
  std::vector<Colour> pixels;

  Image() = default;
  Image(int width, int height, const Colour& colour);

  Colour& at(int x, int y) { return pixels[index(x, y)]; }
  const Colour& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    assert(0 <= x && x < width && 0 <= y && y < height);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// @brief A colour from the usual 0xRRGGBB notation (sRGB).
Colour colourFromHex(std::uint32_t rgb);

/// @brief The picture at 1 / factor of its size. Each pixel is the mean of factor^2
/// pixels.
Image shrunk(const Image& image, int factor);

/// @brief Copies `part` to (x, y). Pixels outside are cut off.
void paste(Image& image, const Image& part, int x, int y);

/// @brief Writes capital letters, digits and .,:-/ from (x, y), the top left corner, in
/// glyphs of 5 x 7 squares of `scale` pixels, 6 apart; other characters stay blank.
void drawText(Image& image, const std::string& text, int x, int y, int scale,
              const Colour& colour);

/// @brief The bytes of an 8 bit RGB PNG (sRGB).
/// @throws std::runtime_error with libpng's message.
std::string encodePng(const Image& image);

/// @brief Reads any PNG as RGB.
/// @throws std::runtime_error that names the file and gives libpng's message.
Image readPng(const std::string& path);

}  // namespace picture
}  // namespace fcl_ccd

#endif
