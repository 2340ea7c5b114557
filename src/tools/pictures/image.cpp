// SPDX-License-Identifier: BSD-3-Clause
#include "image.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fcl_ccd {
namespace picture {
namespace {

float toLight(float srgb) { return std::pow(srgb, 2.2f); }

std::uint8_t toByte(float light) {
  const float srgb = std::pow(std::min(1.0f, std::max(0.0f, light)), 1 / 2.2f);
  return static_cast<std::uint8_t>(std::lround(255 * srgb));
}

/// One glyph: seven rows of five squares, the leftmost in bit 4.
struct Glyph {
  char character;
  std::uint8_t rows[7];
};

const Glyph kFont[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 2, 4, 8, 31}},     {'3', {31, 2, 4, 2, 1, 17, 14}},
    {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
    {'A', {14, 17, 17, 31, 17, 17, 17}}, {'B', {30, 17, 17, 30, 17, 17, 30}},
    {'C', {14, 17, 16, 16, 16, 17, 14}}, {'D', {28, 18, 17, 17, 17, 18, 28}},
    {'E', {31, 16, 16, 30, 16, 16, 31}}, {'F', {31, 16, 16, 30, 16, 16, 16}},
    {'G', {14, 17, 16, 23, 17, 17, 15}}, {'H', {17, 17, 17, 31, 17, 17, 17}},
    {'I', {14, 4, 4, 4, 4, 4, 14}},      {'J', {7, 2, 2, 2, 2, 18, 12}},
    {'K', {17, 18, 20, 24, 20, 18, 17}}, {'L', {16, 16, 16, 16, 16, 16, 31}},
    {'M', {17, 27, 21, 21, 17, 17, 17}}, {'N', {17, 17, 25, 21, 19, 17, 17}},
    {'O', {14, 17, 17, 17, 17, 17, 14}}, {'P', {30, 17, 17, 30, 16, 16, 16}},
    {'Q', {14, 17, 17, 17, 21, 18, 13}}, {'R', {30, 17, 17, 30, 20, 18, 17}},
    {'S', {15, 16, 16, 14, 1, 1, 30}},   {'T', {31, 4, 4, 4, 4, 4, 4}},
    {'U', {17, 17, 17, 17, 17, 17, 14}}, {'V', {17, 17, 17, 17, 17, 10, 4}},
    {'W', {17, 17, 17, 21, 21, 21, 10}}, {'X', {17, 17, 10, 4, 10, 17, 17}},
    {'Y', {17, 17, 17, 10, 4, 4, 4}},    {'Z', {31, 1, 2, 4, 8, 16, 31}},
    {'.', {0, 0, 0, 0, 0, 12, 12}},      {',', {0, 0, 0, 0, 12, 4, 8}},
    {':', {0, 12, 12, 0, 12, 12, 0}},    {'-', {0, 0, 0, 31, 0, 0, 0}},
    {'/', {0, 1, 2, 4, 8, 16, 0}}};

void drawGlyph(Image& image, const Glyph& glyph, int x, int y, int scale,
               const Colour& colour) {
  for (int row = 0; row < 7 * scale; ++row)
    for (int column = 0; column < 5 * scale; ++column) {
      const bool inked = (glyph.rows[row / scale] >> (4 - column / scale)) & 1;
      const int px = x + column;
      const int py = y + row;
      if (inked && px >= 0 && px < image.width && py >= 0 && py < image.height)
        image.at(px, py) = colour;
    }
}

}  // namespace

Image::Image(int width_, int height_, const Colour& colour)
    : width(width_),
      height(height_),
      pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
             colour) {}

Colour colourFromHex(std::uint32_t rgb) {
  const auto channel = [&](int shift) {
    return toLight(static_cast<float>((rgb >> shift) & 255u) / 255);
  };
  return {channel(16), channel(8), channel(0)};
}

Image shrunk(const Image& image, int factor) {
  Image small(image.width / factor, image.height / factor, Colour::Zero());
  const float share = 1 / static_cast<float>(factor * factor);
  for (int y = 0; y < small.height * factor; ++y)
    for (int x = 0; x < small.width * factor; ++x)
      small.at(x / factor, y / factor) += share * image.at(x, y);
  return small;
}

void paste(Image& image, const Image& part, int x, int y) {
  for (int py = std::max(0, -y); py < std::min(part.height, image.height - y); ++py)
    for (int px = std::max(0, -x); px < std::min(part.width, image.width - x); ++px)
      image.at(x + px, y + py) = part.at(px, py);
}

void drawText(Image& image, const std::string& text, int x, int y, int scale,
              const Colour& colour) {
  for (const char character : text) {
    for (const Glyph& glyph : kFont)
      if (glyph.character == character) drawGlyph(image, glyph, x, y, scale, colour);
    x += 6 * scale;
  }
}

std::string encodePng(const Image& image) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixels.size() * 3);
  for (const Colour& c : image.pixels)
    for (int k = 0; k < 3; ++k) bytes.push_back(toByte(c[k]));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // The first call computes the size, the second one writes.
  png_alloc_size_t size = 0;
  std::string encoded;
  for (int pass = 0; pass < 2; ++pass) {
    encoded.resize(size);
    if (!png_image_write_to_memory(&png, pass == 0 ? nullptr : &encoded[0], &size, 0,
                                   bytes.data(), 0, nullptr))
      throw std::runtime_error(std::string("PNG: ") + png.message);
  }
  encoded.resize(size);
  return encoded;
}

Image readPng(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str()))
    throw std::runtime_error(path + ": " + png.message);
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr))
    throw std::runtime_error(path + ": " + png.message);
  Image image(static_cast<int>(png.width), static_cast<int>(png.height), Colour::Zero());
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      image.pixels[i][k] =
          toLight(static_cast<float>(bytes[3 * i + static_cast<std::size_t>(k)]) / 255);
  return image;
}

}  // namespace picture
}  // namespace fcl_ccd
