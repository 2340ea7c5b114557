// SPDX-License-Identifier: BSD-3-Clause
#include "scene_file.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "fcl/config.h"
#include "frame_list.h"
#include "mesh_io.h"
#include "scene_pose.h"

namespace fcl_ccd {
namespace {

const std::vector<std::string> kGeometries{"mesh", "frames", "shape", "octree"};
const std::vector<std::string> kObjectFields{
    "name",  "mesh",  "frames",    "shape",          "octree",
    "poses", "group", "thickness", "self_collision", "min_approach_speed"};

int groupOf(const JsonFile& file, const JsonValue& value) {
  constexpr int kLastGroup = 31;  // of fcl::ContinuousGroups
  return file.wholeNumber(value, 0, kLastGroup);
}

/// What an object has several of, and where.
struct States {
  const JsonValue* value;
  std::size_t count;
  const char* noun;
};

std::string countOf(const States& states) {
  return std::to_string(states.count) + ' ' + states.noun;
}

}  // namespace

bool isSceneFile(const std::string& word) {
  std::error_code error;
  return extensionOf(word) == "json" && !std::filesystem::is_directory(word, error);
}

SceneFile::SceneFile(const std::string& path) : json_(path) {
  const JsonValue& root = json_.root();
  json_.fields(root, {"version", "objects", "groups_apart", "pair_distances"});
  if (const JsonValue* version = json_.find(root, "version"))
    json_.wholeNumber(*version, 1, 1);
  readObjects(json_.require(root, "objects"));
  if (const JsonValue* groups = json_.find(root, "groups_apart")) readGroups(*groups);
  if (const JsonValue* pairs = json_.find(root, "pair_distances"))
    readPairDistances(*pairs);
  countSteps();
}

/// Names are relative to the folder of the scene file.
std::string SceneFile::fileOf(const JsonValue& value) const {
  return (std::filesystem::path(json_.path()).parent_path() / json_.text(value)).string();
}

std::vector<std::string> SceneFile::framesOf(const JsonValue& value) const {
  std::vector<std::string> words;
  if (value.as<JsonValue::List>() == nullptr)
    words.push_back(fileOf(value));
  else
    for (const JsonValue& word : json_.list(value)) words.push_back(fileOf(word));
  try {
    return listFrames(words, FrameRange());
  } catch (const std::runtime_error& error) {
    json_.refuse(value, error.what());
  }
}

void SceneFile::readGeometry(ObjectEntry& object) const {
  const std::string* kind = nullptr;
  for (const std::string& name : kGeometries) {
    const JsonValue* found = json_.find(*object.value, name);
    if (found == nullptr) continue;
    if (kind != nullptr)
      json_.refuse(*found, "the object has '" + *kind + "' too. Give it one geometry");
    kind = &name;
    object.geometry = found;
  }
  if (kind == nullptr)
    json_.refuse(*object.value,
                 "the object has no geometry. Give it one of " + listed(kGeometries));
  const auto requireFile = [&](const std::string& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error))
      json_.refuse(*object.geometry, file + ": cannot open: there is no such file");
  };
  if (*kind == "frames") {
    object.meshes = framesOf(*object.geometry);
  } else if (*kind == "mesh") {
    object.meshes = {fileOf(*object.geometry)};
    requireFile(object.meshes[0]);
  } else if (*kind == "shape") {
    object.shape = readShape(json_, *object.geometry);
  } else {
#if !FCL_HAVE_OCTOMAP
    json_.refuse(*object.geometry,
                 "this FCL was built without octomap, and has no octrees");
#endif
    object.octree = fileOf(*object.geometry);
    requireFile(object.octree);
    const std::string extension = extensionOf(object.octree);
    if (extension != "bt" && extension != "ot")
      json_.refuse(
          *object.geometry,
          object.octree + ": is not an octree. Name a file of octomap: .bt or .ot");
  }
}

ObjectEntry SceneFile::readObject(const JsonValue& value) const {
  json_.fields(value, kObjectFields);
  ObjectEntry object;
  object.value = &value;
  object.name = json_.text(json_.require(value, "name"));
  readGeometry(object);
  if (const JsonValue* poses = json_.find(value, "poses"))
    object.poses = readPoses(json_, *poses);
  else
    object.poses = {fcl::Transform3d::Identity()};
  if (const JsonValue* group = json_.find(value, "group"))
    object.group = groupOf(json_, *group);
  if (const JsonValue* thickness = json_.find(value, "thickness"))
    object.thickness = json_.notNegative(*thickness);
  if (const JsonValue* speed = json_.find(value, "min_approach_speed"))
    object.min_approach_speed = json_.notNegative(*speed);
  const JsonValue* self = json_.find(value, "self_collision");
  if (self != nullptr) object.self_collision = json_.boolean(*self);
  if (object.self_collision && object.meshes.empty())
    json_.refuse(*self, "only a mesh can be tested with itself. Leave the field out");
  return object;
}

void SceneFile::readObjects(const JsonValue& value) {
  for (const JsonValue& entry : json_.list(value)) {
    ObjectEntry object = readObject(entry);
    const auto [first, is_new] = numbers_.emplace(object.name, objects_.size());
    if (!is_new)
      json_.refuse(json_.require(entry, "name"),
                   "the object in line " +
                       std::to_string(objects_[first->second].value->line) +
                       " has the name '" + object.name +
                       "' too. Give each object a name of its own");
    objects_.push_back(std::move(object));
  }
}

void SceneFile::readGroups(const JsonValue& value) {
  for (const JsonValue& entry : json_.list(value)) {
    const JsonValue::List& pair = json_.list(entry, 2);
    groups_.set(groupOf(json_, pair[0]), groupOf(json_, pair[1]), false);
  }
}

/// The number of the object with a name.
std::size_t SceneFile::numberOf(const JsonValue& name) const {
  const std::string& text = json_.text(name);
  const auto found = numbers_.find(text);
  if (found != numbers_.end()) return found->second;
  std::vector<std::string> names;
  for (const ObjectEntry& object : objects_) names.push_back(object.name);
  json_.refuse(name, "there is no object '" + text + "'. " + didYouMean(text, names) +
                         "Write the name of an object of this file");
}

void SceneFile::readPairDistances(const JsonValue& value) {
  std::set<std::pair<std::size_t, std::size_t>> known;
  for (const JsonValue& entry : json_.list(value)) {
    json_.fields(entry, {"objects", "distance"});
    const JsonValue& objects = json_.require(entry, "objects");
    const JsonValue::List& names = json_.list(objects, 2);
    const std::size_t o1 = numberOf(names[0]), o2 = numberOf(names[1]);
    if (!known.insert(std::minmax(o1, o2)).second)
      json_.refuse(objects, "these two have a distance already. Leave one out");
    pair_distances_.push_back(
        {o1, o2, json_.notNegative(json_.require(entry, "distance"))});
  }
}

void SceneFile::countSteps() {
  std::vector<States> all;
  for (const ObjectEntry& object : objects_) {
    if (object.deforms())
      all.push_back({object.geometry, object.meshes.size(), "frames"});
    if (object.poses.size() > 1)
      all.push_back({json_.find(*object.value, "poses"), object.poses.size(), "poses"});
  }
  if (all.empty())
    json_.refuse(json_.require(json_.root(), "objects"),
                 "nothing moves. Give at least one object two poses or two frames");
  const States& first = all.front();
  for (const States& states : all)
    if (states.count != first.count)
      json_.refuse(*states.value,
                   "there are " + countOf(states) + ", but " + countOf(first) +
                       " in line " + std::to_string(first.value->line) +
                       ". Objects that move or deform need the same number. One pose or "
                       "one mesh is for an object at rest");
  num_steps_ = first.count - 1;
}

std::vector<std::string> SceneFile::inputs() const {
  std::vector<std::string> files{json_.path()};
  for (const ObjectEntry& object : objects_) {
    files.insert(files.end(), object.meshes.begin(), object.meshes.end());
    if (!object.octree.empty()) files.push_back(object.octree);
  }
  return files;
}

}  // namespace fcl_ccd
