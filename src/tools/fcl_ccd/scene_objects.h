// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_SCENE_OBJECTS_H
#define FCL_CCD_SCENE_OBJECTS_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "mesh_model.h"
#include "mesh_sequence.h"
#include "scene_file.h"

namespace fcl_ccd {

/// @brief The objects of a scene file in a manager. They have the numbers that they have
/// in the file.
class SceneObjects {
 public:
  using Manager = fcl::ContinuousCollisionManagerd;
  using Object = fcl::ContinuousCollisionObjectd;

  /// @brief Reads meshes and octrees, and checks all frames.
  /// @param file   must outlive this object.
  /// @param notes  lines for the user.
  /// @throws std::runtime_error with the line of the object that cannot be used.
  SceneObjects(const SceneFile& file, int num_threads, std::vector<std::string>& notes);

  /// @brief Reads the frames of a step.
  /// @throws std::runtime_error that names the file.
  void read(std::size_t step);

  /// @brief Gives the objects their motions and frames of the step that was read.
  /// @throws std::runtime_error with the cause.
  void move(std::size_t step);

  const Manager& manager() const { return manager_; }
  std::size_t size() const { return bodies_.size(); }
  const std::string& nameOf(std::size_t i) const { return file_.objects()[i].name; }
  std::size_t numberOf(const Object* object) const { return numbers_.at(object); }

  /// @brief "mesh", "frames", "octree", or the type of the shape.
  std::string kindOf(std::size_t i) const;
  std::size_t numTriangles(std::size_t i) const;

  /// @brief "5" for a triangle, "e5" and "p5" for a free edge and a free point, the
  /// number of a cell. Empty for a shape.
  std::string partName(std::size_t i, std::intptr_t b) const;
  /// @brief The same in words: "triangle 5", "free edge 5", "cell 9"; empty for a shape.
  std::string partWords(std::size_t i, std::intptr_t b) const;

  /// @brief The distance at which two objects are in contact.
  double distanceOf(std::size_t i, std::size_t j) const;

  /// @brief A message of the library with the names of the objects that it numbers.
  std::string withNames(const std::string& message) const;

 private:
  /// What an object is made of.
  struct Body {
    std::shared_ptr<fcl::CollisionGeometryd> geometry;
    std::shared_ptr<MeshModel> mesh;     ///< null if it is no mesh
    std::optional<MeshSequence> frames;  ///< of a mesh that deforms
    Vertices from, to;                   ///< of the step that was read
    std::size_t num_read{0};             ///< the number of the frame `to`, plus 1
    std::unique_ptr<Object> object;
  };
  using Meshes = std::unordered_map<std::string, std::shared_ptr<MeshModel>>;

  Body makeBody(const ObjectEntry& entry, Meshes& known, std::vector<std::string>& notes);
  void addObject(const ObjectEntry& entry, Body body);
  /// What b stands for in a mesh.
  fcl::Primitive primitiveOf(const MeshModel& mesh, std::intptr_t b) const;

  const SceneFile& file_;
  int num_threads_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> changing_;  ///< the objects that change in any step
  std::unordered_map<const Object*, std::size_t> numbers_;
  Manager manager_;  ///< goes before the objects
};

}  // namespace fcl_ccd

#endif
