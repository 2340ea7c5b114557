// SPDX-License-Identifier: BSD-3-Clause
//
// The file of `fcl-ccd run scene.json`: many objects. (scene.h has the one or two meshes
// of `fcl-ccd run` with frames.)
#ifndef FCL_CCD_SCENE_FILE_H
#define FCL_CCD_SCENE_FILE_H

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "fcl/common/types.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "json_tree.h"
#include "scene_shape.h"

namespace fcl_ccd {

/// @brief An object of a scene file. It has one geometry: files of a mesh, a file of an
/// octree, or a shape.
struct ObjectEntry {
  std::string name;
  const JsonValue* value;           ///< the object in the file
  const JsonValue* geometry;        ///< its geometry there
  std::vector<std::string> meshes;  ///< the frames, or one mesh that is rigid
  std::string octree;
  std::optional<SceneShape> shape;
  std::vector<fcl::Transform3d> poses;  ///< at least one
  int group{0};
  double thickness{0};
  double min_approach_speed{0};
  bool self_collision{false};

  bool deforms() const { return meshes.size() > 1; }
  bool changes() const { return deforms() || poses.size() > 1; }
};

/// @brief The distance of two objects, by their numbers.
struct PairDistance {
  std::size_t o1, o2;
  double distance;
};

/// @brief A scene as it is in its file.
class SceneFile {
 public:
  /// @throws std::runtime_error with the file, the line and the field that cannot be
  /// used. The files of the objects are listed, and not read.
  explicit SceneFile(const std::string& path);

  const JsonFile& json() const { return json_; }
  const std::vector<ObjectEntry>& objects() const { return objects_; }
  const std::vector<PairDistance>& pairDistances() const { return pair_distances_; }
  const fcl::ContinuousGroups& groups() const { return groups_; }
  /// @brief Step i goes from the poses and frames i to the next ones. At least one.
  std::size_t numSteps() const { return num_steps_; }

  /// @brief All files that are read.
  std::vector<std::string> inputs() const;

 private:
  std::string fileOf(const JsonValue& value) const;
  std::vector<std::string> framesOf(const JsonValue& value) const;
  void readGeometry(ObjectEntry& object) const;
  ObjectEntry readObject(const JsonValue& value) const;
  void readObjects(const JsonValue& value);
  void readGroups(const JsonValue& value);
  std::size_t numberOf(const JsonValue& name) const;
  void readPairDistances(const JsonValue& value);
  void countSteps();

  JsonFile json_;
  std::vector<ObjectEntry> objects_;
  std::unordered_map<std::string, std::size_t> numbers_;  ///< of the objects
  std::vector<PairDistance> pair_distances_;
  fcl::ContinuousGroups groups_;
  std::size_t num_steps_{0};
};

/// @brief Whether a word of the command line names a scene file.
bool isSceneFile(const std::string& word);

}  // namespace fcl_ccd

#endif
