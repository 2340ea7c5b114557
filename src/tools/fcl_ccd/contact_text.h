// SPDX-License-Identifier: BSD-3-Clause
//
// Contacts as words and as JSON: the names that all outputs of the program have for them.
#ifndef FCL_CCD_CONTACT_TEXT_H
#define FCL_CCD_CONTACT_TEXT_H

#include <cstddef>
#include <string>
#include <vector>

#include "json.h"
#include "scene.h"

namespace fcl_ccd {

/// @brief "vf", "ee", "ve", "vv" or "crossing"; with a shape "vs", "es", "fs" or "ss".
const char* nameOf(fcl::ContinuousContactKind kind);

/// @brief "vertex-face", "edge-edge", "vertex-edge", "vertex-vertex" or "crossing"; with
/// a shape "vertex-shape", "edge-shape", "face-shape" or "shape-shape".
const char* wordsOf(fcl::ContinuousContactKind kind);

/// @brief The number of vertices of the first feature of a contact.
std::size_t firstFeatureSize(fcl::ContinuousContactKind kind);

/// @brief "vertex", "edge" or "face", by the number of its vertices.
const char* featureName(std::size_t num_vertices);

/// @brief The id of a vertex: "3", or "b3" in mesh B.
std::string nameOf(const SceneVertex& vertex);

/// @brief What is before the number of a triangle (nothing), a free edge or a free point.
const char* nameOf(fcl::PrimitiveKind kind);

/// @brief "triangle", "free edge" or "free point".
const char* wordOf(fcl::PrimitiveKind kind);

/// @brief The i-th vertex of a contact or a candidate. Empty: it has fewer.
template <typename Pair>
std::string vertexName(const Pair& pair, std::size_t i) {
  return i < static_cast<std::size_t>(pair.num_vertices) ? nameOf(pair.vertices[i]) : "";
}

/// @brief Whether the first (0) or the second feature (1) of a contact or a candidate is
/// of mesh B. The first and the last vertex tell it.
template <typename Pair>
bool isOfB(const Pair& pair, std::size_t feature) {
  const auto last = static_cast<std::size_t>(pair.num_vertices - 1);
  return pair.vertices[feature * last].of_b;
}

/// @brief The triangle of the first (0) or the second feature (1) of a contact or a
/// candidate: "5", "b5" in mesh B, "e5" for a free edge, "p5" for a free point.
template <typename Pair>
std::string triangleName(const Pair& pair, std::size_t feature) {
  return (isOfB(pair, feature) ? "b" : "") +
         std::string(nameOf(pair.triangle_kinds[feature])) +
         std::to_string(pair.triangles[feature]);
}

/// @brief A number where the name is one, as "5"; otherwise the text, as "e5".
Json numberOrName(const std::string& name);

/// @brief kind, vertices, triangles, toc_lo, toc_hi, position, normal. Names of B, and of
/// free edges and points, are texts; others are numbers.
Json toJson(const SceneContact& contact);

/// @brief The contact of which toJson() made this.
SceneContact contactOf(const Json& json);

/// @brief The contact that a run names as its first one.
struct FirstContact {
  std::size_t step{0};
  std::vector<std::string> files;  ///< of the step
  SceneContact contact;
  /// Other contacts of the step whose brackets overlap that of this one.
  std::size_t as_early{0};
  bool is_decided{true};  ///< false: another contact of the step may be earlier
};

/// @brief Where and when a contact is, as a sentence for the terminal: a line has at most
/// 80 characters, unless a word is longer.
/// @param begin        the begin of the sentence; the step follows
/// @param at_distance  whether contact is to come within a distance
std::string sentenceOf(const std::string& begin, const FirstContact& first,
                       bool at_distance);

}  // namespace fcl_ccd

#endif
