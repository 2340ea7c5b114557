// SPDX-License-Identifier: BSD-3-Clause
#include "contact_text.h"

#include <array>
#include <utility>

#include "counted.h"
#include "number_text.h"
#include "sentence.h"

namespace fcl_ccd {
namespace {

using Kind = fcl::ContinuousContactKind;
using fcl::PrimitiveKind;

struct KindNames {
  Kind kind;
  const char* name;       ///< in files
  const char* words;      ///< in sentences
  int num_vertices;       ///< of both features
  int num_first_feature;  ///< vertices of the first feature
};

constexpr KindNames kKinds[] = {{Kind::kVertexFace, "vf", "vertex-face", 4, 1},
                                {Kind::kEdgeEdge, "ee", "edge-edge", 4, 2},
                                {Kind::kVertexEdge, "ve", "vertex-edge", 3, 1},
                                {Kind::kVertexVertex, "vv", "vertex-vertex", 2, 1},
                                {Kind::kCrossing, "crossing", "crossing", 5, 2},
                                {Kind::kVertexShape, "vs", "vertex-shape", 1, 1},
                                {Kind::kEdgeShape, "es", "edge-shape", 2, 2},
                                {Kind::kFaceShape, "fs", "face-shape", 3, 3},
                                {Kind::kShapes, "ss", "shape-shape", 0, 0}};

const KindNames& namesOf(Kind kind) {
  for (const KindNames& names : kKinds)
    if (names.kind == kind) return names;
  return kKinds[4];
}

/// A vertex, or a triangle with what it stands for.
struct ParsedName {
  bool of_b{false};
  PrimitiveKind kind{PrimitiveKind::kTriangle};
  long long number{0};
};

ParsedName parseName(const Json& json) {
  ParsedName parsed;
  if (json.is_number()) {
    json.get_to(parsed.number);
    return parsed;
  }
  std::string name = json;
  const auto skip = [&](char letter) {
    const bool found = !name.empty() && name[0] == letter;
    if (found) name.erase(0, 1);
    return found;
  };
  parsed.of_b = skip('b');
  if (skip('e')) parsed.kind = PrimitiveKind::kFreeEdge;
  if (skip('p')) parsed.kind = PrimitiveKind::kFreePoint;
  parsed.number = std::stoll(name);
  return parsed;
}

/// "vertex 3 of triangle 1", "edge b0 b1 of free edge b7".
std::string featureText(const SceneContact& contact, std::size_t feature) {
  const auto num_first = firstFeatureSize(contact.kind),
             num_all = static_cast<std::size_t>(contact.num_vertices);
  const std::size_t begin = feature == 0 ? 0 : num_first,
                    end = feature == 0 ? num_first : num_all;
  std::string text = featureName(end - begin);
  for (std::size_t i = begin; i < end; ++i) text += ' ' + nameOf(contact.vertices[i]);
  return text + " of " + wordOf(contact.triangle_kinds[feature]) + ' ' +
         (isOfB(contact, feature) ? "b" : "") +
         std::to_string(contact.triangles[feature]);
}

}  // namespace

const char* nameOf(Kind kind) { return namesOf(kind).name; }

const char* wordsOf(Kind kind) { return namesOf(kind).words; }

std::size_t firstFeatureSize(Kind kind) {
  return static_cast<std::size_t>(namesOf(kind).num_first_feature);
}

const char* featureName(std::size_t num_vertices) {
  constexpr std::array<const char*, 4> kFeatures{"", "vertex", "edge", "face"};
  return kFeatures.at(num_vertices);
}

std::string nameOf(const SceneVertex& vertex) {
  return (vertex.of_b ? "b" : "") + std::to_string(vertex.id);
}

const char* nameOf(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kFreeEdge:
      return "e";
    case PrimitiveKind::kFreePoint:
      return "p";
    default:
      return "";
  }
}

const char* wordOf(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kFreeEdge:
      return "free edge";
    case PrimitiveKind::kFreePoint:
      return "free point";
    default:
      return "triangle";
  }
}

Json numberOrName(const std::string& name) {
  if (name.find_first_not_of("0123456789") != std::string::npos) return name;
  return std::stoll(name);
}

Json toJson(const SceneContact& contact) {
  Json vertices = Json::array();
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i)
    vertices.push_back(numberOrName(nameOf(contact.vertices[i])));
  return {
      {"kind", nameOf(contact.kind)},
      {"vertices", std::move(vertices)},
      {"triangles",
       {numberOrName(triangleName(contact, 0)), numberOrName(triangleName(contact, 1))}},
      {"toc_lo", contact.toc_lo},
      {"toc_hi", contact.toc_hi},
      {"position", contact.position},
      {"normal", contact.normal}};
}

SceneContact contactOf(const Json& json) {
  SceneContact contact;
  const std::string kind = json.at("kind");
  for (const KindNames& names : kKinds)
    if (kind == names.name) contact.kind = names.kind;
  const Json& vertices = json.at("vertices");
  contact.num_vertices = namesOf(contact.kind).num_vertices;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contact.num_vertices); ++i) {
    const ParsedName name = parseName(vertices.at(i));
    contact.vertices[i] = {static_cast<int>(name.number), name.of_b};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const ParsedName name = parseName(json.at("triangles").at(i));
    contact.triangles[i] = static_cast<std::intptr_t>(name.number);
    contact.triangle_kinds[i] = name.kind;
  }
  json.at("toc_lo").get_to(contact.toc_lo);
  json.at("toc_hi").get_to(contact.toc_hi);
  json.at("position").get_to(contact.position);
  json.at("normal").get_to(contact.normal);
  return contact;
}

std::string sentenceOf(const std::string& begin, const FirstContact& first,
                       bool at_distance) {
  const SceneContact& contact = first.contact;
  std::string text = begin + " step " + std::to_string(first.step) + " at " +
                     numberText(contact.toc_lo, 9) + ", between " +
                     unbroken(first.files[0]) + " and " + unbroken(first.files[1]) +
                     ": " + namesOf(contact.kind).words + ", " + featureText(contact, 0) +
                     (contact.kind == Kind::kCrossing ? " passes through "
                      : at_distance                   ? " comes near "
                                                      : " meets ") +
                     featureText(contact, 1) + " at " + pointText(contact.position) +
                     ", " + normalText(contact.normal);
  if (first.as_early > 0)
    text += "; " + counted(first.as_early, "other") + " may be as early";
  return wrapped(text);
}

}  // namespace fcl_ccd
