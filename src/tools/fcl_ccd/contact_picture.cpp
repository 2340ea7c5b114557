// SPDX-License-Identifier: BSD-3-Clause
#include "contact_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "contact_text.h"
#include "moment.h"
#include "number_text.h"
#include "render.h"

namespace fcl_ccd {
namespace {

using Kind = fcl::ContinuousContactKind;
using Vec = fcl::Vector3<double>;
using picture::Image;
using picture::Marker;

constexpr int kWidth = 800, kHeight = 600;            // pixels
constexpr int kInsetWidth = 224, kInsetHeight = 168;  // pixels

// The colours of the demo.
constexpr std::uint32_t kVertexFace = 0xe63946, kEdgeEdge = 0x1d3557, kOther = 0x7b2cbf,
                        kText = 0x444a52, kFrontOfA = 0x2a9d8f, kBackOfA = 0xe9c46a,
                        kB = 0xb9bec5;

std::uint32_t colourOf(Kind kind) {
  return kind == Kind::kVertexFace ? kVertexFace
         : kind == Kind::kEdgeEdge ? kEdgeEdge
                                   : kOther;
}

Vec toVec(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

/// The scene, and the contacts that are there at the moment.
struct View {
  picture::PaintedMesh scene;
  std::vector<Marker> dots;  ///< the places of all contacts
};

View paint(const SceneTriangles& triangles, const Mesh& mesh, double time,
           const StepResult& result) {
  View view;
  for (const auto& p : mesh.vertices) view.scene.mesh.vertices.push_back(toVec(p));
  const auto front = picture::colourFromHex(kFrontOfA),
             back = picture::colourFromHex(kBackOfA), grey = picture::colourFromHex(kB);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& t = mesh.triangles[f];
    view.scene.mesh.triangles.emplace_back(static_cast<std::size_t>(t[0]),
                                           static_cast<std::size_t>(t[1]),
                                           static_cast<std::size_t>(t[2]));
    const bool of_a = f < triangles.a->size();
    view.scene.paints.push_back({of_a ? front : grey, of_a ? back : grey, false});
  }
  // The earliest last: its colour wins.
  for (auto c = result.contacts.rbegin(); c != result.contacts.rend(); ++c) {
    if (c->toc_lo > time) continue;
    const picture::Colour colour = picture::colourFromHex(colourOf(c->kind));
    view.dots.push_back({toVec(c->position), colour});
    for (const std::size_t feature : {0u, 1u})
      if (const auto f = triangleInScene(*c, feature, triangles)) {
        picture::Paint& paint = view.scene.paints[*f];
        for (picture::Colour* side : {&paint.front, &paint.back})
          *side = 0.5f * *side + 0.5f * colour;
      }
  }
  return view;
}

/// A ball that is to fill the picture.
struct Region {
  Vec centre;
  double radius;
};

Region regionOfAll(const picture::Surface& mesh) {
  Vec lo = Vec::Constant(std::numeric_limits<double>::max()), hi = -lo;
  for (const Vec& v : mesh.vertices) {
    lo = lo.cwiseMin(v);
    hi = hi.cwiseMax(v);
  }
  const double radius = (0.5 * hi - 0.5 * lo).norm();
  return {0.5 * lo + 0.5 * hi, radius > 0 ? radius : 1};
}

/// The surroundings of a contact: some triangles of the size of the smaller one of both.
Region regionOf(const SceneContact& contact, const SceneTriangles& triangles,
                const picture::Surface& mesh, const Region& all) {
  constexpr double kTriangles = 2.5;
  const Vec place = toVec(contact.position);
  double radius = all.radius;
  for (const std::size_t feature : {0u, 1u}) {
    const auto f = triangleInScene(contact, feature, triangles);
    if (!f) continue;
    double reach = 0;
    for (int k = 0; k < 3; ++k)
      reach = std::max(reach, (mesh.vertices[mesh.triangles[*f][k]] - place).norm());
    if (reach > 0) radius = std::min(radius, kTriangles * reach);
  }
  return {place, radius};
}

/// Whether a ray from a point meets a triangle.
bool meets(const Vec& origin, const Vec& direction, const std::array<Vec, 3>& t) {
  const Vec edge1 = t[1] - t[0], edge2 = t[2] - t[0], across = direction.cross(edge2);
  const double determinant = edge1.dot(across);
  if (determinant == 0) return false;
  const Vec from = origin - t[0];
  const double u = from.dot(across) / determinant;
  const Vec along = from.cross(edge1);
  const double v = direction.dot(along) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && edge2.dot(along) / determinant > 0;
}

std::array<Vec, 3> cornersOf(const picture::Surface& mesh, std::size_t f) {
  const fcl::Triangle& t = mesh.triangles[f];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// The part of the scene near a region.
picture::PaintedMesh partAround(const Region& region, const picture::PaintedMesh& scene,
                                double reach) {
  picture::PaintedMesh part;
  part.mesh.vertices = scene.mesh.vertices;
  for (std::size_t f = 0; f < scene.mesh.triangles.size(); ++f) {
    const auto t = cornersOf(scene.mesh, f);
    const Vec lo = t[0].cwiseMin(t[1]).cwiseMin(t[2]),
              hi = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    const Vec nearest = region.centre.cwiseMax(lo).cwiseMin(hi);
    if ((nearest - region.centre).norm() > reach * region.radius) continue;
    part.mesh.triangles.push_back(scene.mesh.triangles[f]);
    part.paints.push_back(scene.paints[f]);
  }
  return part;
}

/// The direction to the viewer from which the contact is seen best: nothing near is
/// before it, and both surfaces are seen from the side, from above.
Vec directionOfView(const Region& region, const Vec& normal,
                    const picture::PaintedMesh& scene) {
  const picture::PaintedMesh near = partAround(region, scene, 1.0);
  constexpr int kDirections = 96;
  const double golden_angle = std::acos(-1.0) * (3 - std::sqrt(5.0));
  Vec best = Vec(0.6, -0.65, 0.45).normalized();
  double best_score = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    const Vec direction(r * std::cos(i * golden_angle), r * std::sin(i * golden_angle),
                        z);
    // A little off the contact, on the side of the viewer: its own triangles meet there.
    const Vec start = region.centre + 0.02 * region.radius * direction;
    int blocked = 0;
    for (std::size_t f = 0; f < near.mesh.triangles.size(); ++f)
      blocked += meets(start, direction, cornersOf(near.mesh, f));
    const double score = -2 * blocked - std::abs(std::abs(normal.dot(direction)) - 0.35) -
                         std::abs(z - 0.4);
    if (score <= best_score) continue;
    best_score = score;
    best = direction;
  }
  return best;
}

/// Draws a region from a direction. The renderer's shadows are made for scenes of metres.
Image draw(View view, const Region& region, const Vec& direction, int width, int height) {
  constexpr double kHalfAngle = 0.2, kRadius = 0.5;  // radians, metres
  const double scale = kRadius / region.radius;
  for (Vec& v : view.scene.mesh.vertices) v = scale * (v - region.centre);
  for (Marker& dot : view.dots) dot.position = scale * (dot.position - region.centre);
  picture::Camera camera;
  camera.vertical_view_angle = 2 * kHalfAngle;
  camera.target = Vec::Zero();
  camera.eye = 1.05 * kRadius / std::sin(kHalfAngle) * direction;
  picture::RenderOptions options;
  options.width = width;
  options.height = height;
  // In a small picture nobody sees more.
  options.sky_lights = width == kWidth ? 8 : 3;
  options.shadow_size = 1024;
  options.marker_radius = width / 420.0;
  return picture::render(view.scene, view.dots, camera, options);
}

/// Leaves out the triangles that are before the region, and then the vertices that no
/// triangle has.
void cutOpen(const Region& region, const Vec& direction, picture::PaintedMesh& scene) {
  picture::PaintedMesh rest;
  for (std::size_t f = 0; f < scene.mesh.triangles.size(); ++f) {
    double deepest = std::numeric_limits<double>::max();
    for (const Vec& corner : cornersOf(scene.mesh, f))
      deepest = std::min(deepest, (corner - region.centre).dot(direction));
    if (deepest > region.radius) continue;
    rest.mesh.triangles.push_back(scene.mesh.triangles[f]);
    rest.paints.push_back(scene.paints[f]);
  }
  std::vector<std::size_t> ids(scene.mesh.vertices.size(), scene.mesh.vertices.size());
  for (fcl::Triangle& t : rest.mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      std::size_t& id = ids[t[k]];
      if (id == ids.size()) {
        id = rest.mesh.vertices.size();
        rest.mesh.vertices.push_back(scene.mesh.vertices[t[k]]);
      }
      t[k] = id;
    }
  scene = std::move(rest);
}

/// A line as a row of dots, which the renderer hides as it does the surfaces.
void addLine(const Vec& from, const Vec& to, const Marker& dot,
             std::vector<Marker>& dots) {
  constexpr int kDots = 240;
  for (int i = 0; i <= kDots; ++i) {
    const double share = static_cast<double>(i) / kDots;
    dots.push_back(dot);
    dots.back().position = (1 - share) * from + share * to;
  }
}

/// The edges of a triangle.
void addOutline(const picture::Surface& mesh, std::size_t f, const Marker& dot,
                std::vector<Marker>& dots) {
  const auto t = cornersOf(mesh, f);
  for (std::size_t k = 0; k < 3; ++k) addLine(t[k], t[(k + 1) % 3], dot, dots);
}

Image drawSurroundings(const View& whole, const SceneContact& contact,
                       const Region& region, const SceneTriangles& triangles) {
  constexpr double kReach = 5;  // radii that the picture shows, with its depth
  const Vec normal = toVec(contact.normal);
  const Vec direction = directionOfView(region, normal, whole.scene);
  View view{partAround(region, whole.scene, kReach), whole.dots};
  cutOpen(region, direction, view.scene);
  const picture::Colour colour = picture::colourFromHex(colourOf(contact.kind)),
                        grey = picture::colourFromHex(kText);
  const picture::Surface near = partAround(region, whole.scene, 1).mesh;
  // Of more triangles the outlines would be no help, and their dots take gigabytes: near
  // a free point is the whole scene.
  constexpr std::size_t kMostOutlines = 2000;
  if (near.triangles.size() <= kMostOutlines)
    for (std::size_t f = 0; f < near.triangles.size(); ++f)
      addOutline(near, f, {Vec::Zero(), grey, 0.25}, view.dots);
  for (const std::size_t feature : {0u, 1u})
    if (const auto f = triangleInScene(contact, feature, triangles))
      addOutline(whole.scene.mesh, *f, {Vec::Zero(), colour, 0.6}, view.dots);
  addLine(region.centre, region.centre + 0.6 * region.radius * normal,
          {Vec::Zero(), grey, 0.6}, view.dots);
  view.dots.push_back({region.centre, colour, 3, true});
  return draw(std::move(view), region, direction, kWidth, kHeight);
}

Image drawWhole(View view, const SceneContact* contact, const Region& all, int width,
                int height) {
  if (contact != nullptr)
    view.dots.push_back({toVec(contact->position),
                         picture::colourFromHex(colourOf(contact->kind)), 4, true});
  return draw(std::move(view), all, Vec(0.6, -0.65, 0.45).normalized(), width, height);
}

void writeCaption(Image& image, const StepMoment& moment, const SceneContact* contact) {
  const auto line = [&](int row, std::string text, std::uint32_t colour) {
    // Capital letters are those that the pictures have.
    for (char& c : text) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    picture::drawText(image, text, 16, 16 + 22 * row, 2, picture::colourFromHex(colour));
  };
  line(0, "STEP " + std::to_string(moment.step) + "   T " + numberText(moment.time, 6),
       kText);
  if (contact == nullptr) return line(1, "NO CONTACT", kText);
  std::string text = wordsOf(contact->kind);
  for (int i = 0; i < contact->num_vertices; ++i) {
    const SceneVertex& vertex = contact->vertices[static_cast<std::size_t>(i)];
    text += ' ' + nameOf(vertex);
  }
  line(1, text, colourOf(contact->kind));
}

void addInset(const Image& inset, Image& image) {
  constexpr int kBorder = 2, kMargin = 14;
  const int x = kWidth - kMargin - kInsetWidth, y = kHeight - kMargin - kInsetHeight;
  picture::paste(image,
                 Image(kInsetWidth + 2 * kBorder, kInsetHeight + 2 * kBorder,
                       picture::colourFromHex(kText)),
                 x - kBorder, y - kBorder);
  picture::paste(image, inset, x, y);
}

}  // namespace

std::string drawContact(const SceneTriangles& triangles, const SceneFrame& from,
                        const SceneFrame& to, const StepMoment& moment,
                        const StepResult& result) {
  const Mesh mesh = meshAt(triangles, from, to, moment.time);
  const View view = paint(triangles, mesh, moment.time, result);
  const Region all = regionOfAll(view.scene.mesh);
  const SceneContact* contact = result.earliest();
  Image image;
  if (contact == nullptr) {
    image = drawWhole(view, nullptr, all, kWidth, kHeight);
  } else {
    const Region region = regionOf(*contact, triangles, view.scene.mesh, all);
    image = drawSurroundings(view, *contact, region, triangles);
    addInset(drawWhole(view, contact, all, kInsetWidth, kInsetHeight), image);
  }
  writeCaption(image, moment, contact);
  return picture::encodePng(image);
}

}  // namespace fcl_ccd
