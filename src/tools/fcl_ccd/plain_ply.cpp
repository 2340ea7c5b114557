// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <stdexcept>

#include "plain_mesh.h"
#include "ply_header.h"
#include "text_scan.h"

namespace fcl_ccd {
namespace {

[[noreturn]] void failAtEnd() { throw std::runtime_error("the file ends here"); }

/// Walks over the values of an ascii body.
class AsciiBody {
 public:
  explicit AsciiBody(std::string_view body) : body_(body) {}

  unsigned long long takeCount(PlyType type) {
    const long long count = takeInteger(type);
    if (count < 0) throw std::runtime_error("a list has a negative length");
    return static_cast<unsigned long long>(count);
  }

  /// The loop ends at the latest with the file: each value takes a byte or throws.
  void skip(PlyType type, unsigned long long count) {
    for (unsigned long long i = 0; i < count; ++i) skipValue(type);
  }

  bool atEnd() {
    std::string_view rest = body_, token;
    return !takeToken(rest, token);
  }

 private:
  void skipValue(PlyType type) {
    if (!isFloating(type)) {
      takeInteger(type);
      return;
    }
    std::string_view token;
    if (!takeToken(body_, token)) failAtEnd();
    requireFinite(token);
  }

  long long takeInteger(PlyType type) {
    std::string_view token;
    if (!takeToken(body_, token)) failAtEnd();
    long long value = 0;
    if (!parseInteger(token, value))
      throw std::runtime_error(quoted(token) + " is not an integer");
    const int bits = static_cast<int>(8 * sizeOf(type)) - (isSigned(type) ? 1 : 0);
    const long long end = 1LL << bits;
    if (value >= end || value < (isSigned(type) ? -end : 0))
      throw std::runtime_error(quoted(token) + " does not fit its type");
    return value;
  }

  std::string_view body_;
};

/// Walks over the values of a binary body.
class BinaryBody {
 public:
  BinaryBody(std::string_view body, PlyFormat format)
      : body_(body), big_endian_(format == PlyFormat::kBigEndian) {}

  unsigned long long takeCount(PlyType type) {
    const std::size_t size = sizeOf(type);
    if (body_.size() < size) failAtEnd();
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t shift = 8 * (big_endian_ ? size - 1 - i : i);
      value |= std::uint32_t{static_cast<unsigned char>(body_[i])} << shift;
    }
    body_.remove_prefix(size);
    if (isSigned(type) && (value >> (8 * size - 1)) != 0)
      throw std::runtime_error("a list has a negative length");
    return value;
  }

  void skip(PlyType type, unsigned long long count) {
    if (count > body_.size() / sizeOf(type)) failAtEnd();
    body_.remove_prefix(static_cast<std::size_t>(count) * sizeOf(type));
  }

  bool atEnd() {
    std::string_view rest = body_, token;
    return !takeToken(rest, token);
  }

 private:
  std::string_view body_;
  bool big_endian_;
};

template <typename Body>
void walkItem(const PlyElement& element, Body& body) {
  for (const PlyProperty& property : element.properties)
    body.skip(property.type, property.is_list ? body.takeCount(property.count_type) : 1);
}

/// @brief Throws unless the body has exactly the values that the header promises.
template <typename Body>
void walk(const PlyHeader& header, Body body) {
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    for (unsigned long long i = 0; i < element.count; ++i) {
      const auto place = [&] {
        const bool is_ours = element.isVertex() || element.isFace();
        return (is_ours ? element.name : quoted(element.name)) + ' ' + std::to_string(i) +
               " of " + std::to_string(element.count) + " (counted from 0)";
      };
      namingPlace(place, [&] { walkItem(element, body); });
    }
  }
  if (!body.atEnd()) throw std::runtime_error("more data than the header promises");
}

}  // namespace

std::string plainPly(std::string_view file) {
  const PlyHeader header = takePlyHeader(file);
  if (header.format == PlyFormat::kAscii)
    walk(header, AsciiBody(file));
  else
    walk(header, BinaryBody(file, header.format));
  return plainPlyHeader(header).append(file);
}

}  // namespace fcl_ccd
