// SPDX-License-Identifier: BSD-3-Clause
#include "demo_pictures.h"

#include <cstdio>

#include "mesh_io.h"
#include "pictures.h"

namespace fcl {
namespace test {
namespace {

const std::uint32_t kVertexFaceColour = 0xe63946;
const std::uint32_t kEdgeEdgeColour = 0x1d3557;
const std::uint32_t kTextColour = 0x444a52;

using Body = ClothOverBall::Body;

std::uint32_t frontColour(Body body) {
  return body == ClothOverBall::kCloth  ? 0x2a9d8f
         : body == ClothOverBall::kBall ? 0xb9bec5
                                        : 0xf4f5f7;
}

std::uint32_t backColour(Body body) {
  return body == ClothOverBall::kCloth ? 0xe9c46a : frontColour(body);
}

std::uint32_t contactColour(const ContinuousContact<double>& contact) {
  return contact.kind == ContinuousContactKind::kVertexFace ? kVertexFaceColour
                                                            : kEdgeEdgeColour;
}

Body bodyOfTriangle(const ClothOverBall& scene, std::size_t f) {
  return scene.bodyOf(scene.mesh().triangles[f][0]);
}

/// Calls visit(triangle, colour) for the triangles in contact, vertex-face last so that
/// its colour wins. The ground's triangles are too large to be coloured.
template <typename Visit>
void forEachContactTriangle(const ClothOverBall& scene, const Snapshot& snapshot,
                            Visit visit) {
  for (const auto kind :
       {ContinuousContactKind::kEdgeEdge, ContinuousContactKind::kVertexFace})
    for (const ContinuousContact<double>& contact : snapshot.contacts)
      for (const auto triangle : {contact.b1, contact.b2}) {
        const auto f = static_cast<std::size_t>(triangle);
        if (contact.kind == kind && bodyOfTriangle(scene, f) != ClothOverBall::kGround)
          visit(f, contactColour(contact));
      }
}

PaintedMesh paint(const ClothOverBall& scene, const Snapshot& snapshot) {
  PaintedMesh painted;
  painted.mesh.vertices = snapshot.vertices;
  painted.mesh.triangles = scene.mesh().triangles;
  for (std::size_t f = 0; f < painted.mesh.triangles.size(); ++f) {
    const Body body = bodyOfTriangle(scene, f);
    painted.paints.push_back({colourFromHex(frontColour(body)),
                              colourFromHex(backColour(body)),
                              body == ClothOverBall::kGround});
  }
  forEachContactTriangle(scene, snapshot, [&](std::size_t f, std::uint32_t colour) {
    Paint& paint = painted.paints[f];
    const Body body = bodyOfTriangle(scene, f);
    const auto tinted = [&](std::uint32_t own) -> Colour {
      return 0.4f * colourFromHex(own) + 0.6f * colourFromHex(colour);
    };
    paint.front = tinted(frontColour(body));
    paint.back = tinted(backColour(body));
  });
  return painted;
}

/// A dot at each feature of the cloth that touched: a vertex, or the middle of an edge.
std::vector<Marker> markers(const ClothOverBall& scene, const Snapshot& snapshot) {
  std::vector<Marker> dots;
  const auto add = [&](const ContinuousContact<double>& contact, std::size_t first,
                       std::size_t count) {
    Marker dot{Vector3<double>::Zero(), colourFromHex(contactColour(contact))};
    bool is_on_cloth = true;
    for (std::size_t k = first; k < first + count; ++k) {
      const auto v = static_cast<std::size_t>(contact.vertices[k]);
      dot.position += snapshot.vertices[v] / static_cast<double>(count);
      is_on_cloth &= scene.bodyOf(v) == ClothOverBall::kCloth;
    }
    if (is_on_cloth) dots.push_back(dot);
  };
  for (const ContinuousContact<double>& contact : snapshot.contacts) {
    if (contact.kind == ContinuousContactKind::kVertexFace) {
      add(contact, 0, 1);
    } else {
      add(contact, 0, 2);
      add(contact, 2, 2);
    }
  }
  return dots;
}

void writeCaption(Image& image, const Snapshot& snapshot) {
  const int scale = image.width / 400;
  const int left = 8 * scale;
  const auto line = [&](int row, const std::string& text, std::uint32_t colour) {
    drawText(image, text, left, (8 + 11 * row) * scale, scale, colourFromHex(colour));
  };
  char title[64];
  std::snprintf(title, sizeof(title), "FRAME %d   %.2f S", snapshot.frame, snapshot.time);
  line(0, title, kTextColour);
  line(1, "VERTEX-FACE " + std::to_string(snapshot.vertex_face), kVertexFaceColour);
  line(2, "EDGE-EDGE   " + std::to_string(snapshot.edge_edge), kEdgeEdgeColour);
}

}  // namespace

Snapshot takeSnapshot(const ClothOverBall& scene, const DemoFrame& frame) {
  return {scene.frame(),   scene.time(),   frame.vertex_face,
          frame.edge_edge, frame.contacts, scene.mesh().vertices};
}

Image drawSnapshot(const ClothOverBall& scene, const Snapshot& snapshot, int width,
                   int height) {
  Camera camera;
  camera.eye = Vector3<double>(1.75, -2.1, 1.5);
  camera.target = Vector3<double>(0.03, 0, 0.14);
  camera.vertical_view_angle = 0.46;
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.marker_radius = width / 800.0;
  Image image = render(paint(scene, snapshot), markers(scene, snapshot), camera, options);
  writeCaption(image, snapshot);
  return image;
}

Image drawSheet(const ClothOverBall& scene, const std::vector<Snapshot>& snapshots,
                int width, int height) {
  const int count = static_cast<int>(snapshots.size());
  const int columns = count > 1 ? 2 : 1;
  const int rows = (count + columns - 1) / columns;
  Image sheet(columns * width, rows * height, RenderOptions().background);
  for (int i = 0; i < count; ++i)
    paste(sheet,
          drawSnapshot(scene, snapshots[static_cast<std::size_t>(i)], width, height),
          (i % columns) * width, (i / columns) * height);
  return sheet;
}

std::string encodeSnapshot(const ClothOverBall& scene, const Snapshot& snapshot) {
  const auto bytes = [](std::uint32_t rgb) {
    return fcl_ccd::Colour{{static_cast<std::uint8_t>(rgb >> 16),
                            static_cast<std::uint8_t>(rgb >> 8),
                            static_cast<std::uint8_t>(rgb)}};
  };
  fcl_ccd::Mesh mesh;
  std::vector<fcl_ccd::Colour> colours;
  for (std::size_t v = 0; v < snapshot.vertices.size(); ++v) {
    const Vector3<double>& p = snapshot.vertices[v];
    mesh.vertices.push_back({{p[0], p[1], p[2]}});
    colours.push_back(bytes(frontColour(scene.bodyOf(v))));
  }
  const auto& triangles = scene.mesh().triangles;
  for (const Triangle& t : triangles)
    mesh.triangles.push_back(
        {{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])}});
  forEachContactTriangle(scene, snapshot, [&](std::size_t f, std::uint32_t colour) {
    for (int k = 0; k < 3; ++k) colours[triangles[f][k]] = bytes(colour);
  });
  return fcl_ccd::encodePaintedPly(mesh, colours);
}

}  // namespace test
}  // namespace fcl
