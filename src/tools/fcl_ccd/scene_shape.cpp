// SPDX-License-Identifier: BSD-3-Clause
#include "scene_shape.h"

#include <utility>
#include <vector>

#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/capsule.h"
#include "fcl/geometry/shape/cone.h"
#include "fcl/geometry/shape/convex.h"
#include "fcl/geometry/shape/cylinder.h"
#include "fcl/geometry/shape/ellipsoid.h"
#include "fcl/geometry/shape/halfspace.h"
#include "fcl/geometry/shape/plane.h"
#include "fcl/geometry/shape/sphere.h"
#include "scene_pose.h"

namespace fcl_ccd {
namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// The fields of a shape.
struct ShapeFields {
  const JsonFile& file;
  const JsonValue& value;

  const JsonValue& at(const char* name) const { return file.require(value, name); }
  double size(const char* name) const { return file.positive(at(name)); }
  fcl::Vector3d sizes(const char* name) const {
    fcl::Vector3d sizes = readPoint(file, at(name));
    for (const JsonValue& size : file.list(at(name))) file.positive(size);
    return sizes;
  }
  fcl::Vector3d normal() const {
    fcl::Vector3d normal = readPoint(file, at("normal"));
    // Its square must neither be 0 nor overflow.
    if (!(normal.squaredNorm() > 1e-200 && normal.squaredNorm() < 1e200))
      file.refuse(at("normal"), "the normal has no direction. Write a unit vector");
    return normal;
  }
  double number(const char* name) const { return file.number(at(name)); }
};

Geometry makeConvex(const ShapeFields& fields) {
  auto corners = std::make_shared<std::vector<fcl::Vector3d>>();
  for (const JsonValue& corner : fields.file.list(fields.at("vertices")))
    corners->push_back(readPoint(fields.file, corner));
  // The library takes the vertices alone.
  return std::make_shared<fcl::Convexd>(std::move(corners), 0,
                                        std::make_shared<std::vector<int>>());
}

/// A type of shapes.
struct ShapeType {
  std::string name;
  std::vector<std::string> fields;  ///< all of them are required
  Geometry (*make)(const ShapeFields& fields);
};

const std::vector<ShapeType>& shapeTypes() {
  using Fields = const ShapeFields&;
  static const std::vector<ShapeType> types{
      {"sphere",
       {"radius"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Sphered>(shape.size("radius"));
       }},
      {"box",
       {"sides"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Boxd>(shape.sizes("sides"));
       }},
      {"capsule",
       {"radius", "length"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Capsuled>(shape.size("radius"),
                                                shape.size("length"));
       }},
      {"cylinder",
       {"radius", "length"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Cylinderd>(shape.size("radius"),
                                                 shape.size("length"));
       }},
      {"cone",
       {"radius", "length"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Coned>(shape.size("radius"), shape.size("length"));
       }},
      {"ellipsoid",
       {"radii"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Ellipsoidd>(shape.sizes("radii"));
       }},
      {"plane",
       {"normal", "offset"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Planed>(shape.normal(), shape.number("offset"));
       }},
      {"halfspace",
       {"normal", "offset"},
       [](Fields shape) -> Geometry {
         return std::make_shared<fcl::Halfspaced>(shape.normal(), shape.number("offset"));
       }},
      {"convex", {"vertices"}, makeConvex}};
  return types;
}

}  // namespace

SceneShape readShape(const JsonFile& file, const JsonValue& value) {
  if (value.as<JsonValue::Members>() == nullptr) file.fields(value, {});
  const JsonValue& type = file.require(value, "type");
  std::vector<std::string> names;
  for (const ShapeType& known : shapeTypes()) {
    names.push_back(known.name);
    if (file.text(type) != known.name) continue;
    std::vector<std::string> fields{"type"};
    fields.insert(fields.end(), known.fields.begin(), known.fields.end());
    file.fields(value, fields);
    return {known.name, known.make({file, value})};
  }
  file.refuse(type, '\'' + file.text(type) + "' is not a type of shapes. " +
                        didYouMean(file.text(type), names) +
                        "The types are: " + listed(names));
}

}  // namespace fcl_ccd
