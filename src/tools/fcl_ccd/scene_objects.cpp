// SPDX-License-Identifier: BSD-3-Clause
#include "scene_objects.h"

#include <cctype>
#include <exception>
#include <stdexcept>

#include "contact_text.h"
#include "fcl/config.h"
#include "frame_list.h"
#include "scene_octree.h"
#include "weld.h"

namespace fcl_ccd {
namespace {

using Motion = std::shared_ptr<fcl::MotionBased>;

/// The motion of a step; that of an object with one pose rests.
Motion motionOf(const ObjectEntry& entry, std::size_t step) {
  const std::vector<fcl::Transform3d>& poses = entry.poses;
  const bool moves = poses.size() > 1;
  return fcl::detail::makeMotionBetween<double>(poses[moves ? step : 0],
                                                poses[moves ? step + 1 : 0]);
}

MeshModel makeModel(const MeshSequence& mesh, int num_threads) {
  return buildModel(toInput(mesh.firstVertices(), mesh.triangles(), &mesh.free()),
                    mesh.path(0), num_threads);
}

}  // namespace

SceneObjects::SceneObjects(const SceneFile& file, int num_threads,
                           std::vector<std::string>& notes)
    : file_(file), num_threads_(num_threads) {
  Meshes meshes;
  for (const ObjectEntry& entry : file.objects()) {
    try {
      addObject(entry, makeBody(entry, meshes, notes));
    } catch (const std::runtime_error& error) {
      file.json().refuse(*entry.geometry, error.what());
    }
  }
  for (const PairDistance& pair : file.pairDistances())
    manager_.setPairDistance(bodies_[pair.o1].object.get(), bodies_[pair.o2].object.get(),
                             pair.distance);
}

SceneObjects::Body SceneObjects::makeBody(const ObjectEntry& entry, Meshes& known,
                                          std::vector<std::string>& notes) {
  Body body;
  if (entry.shape) {
    body.geometry = entry.shape->geometry;
    return body;
  }
  if (!entry.octree.empty()) {
    body.geometry = readOctree(entry.octree);
    return body;
  }
  // Objects of the same file have one model, unless they deform.
  std::shared_ptr<MeshModel>& shared = known[entry.meshes[0]];
  if (!shared || entry.deforms() || entry.self_collision) {
    MeshSequence mesh(entry.meshes);
    for (std::size_t frame = 1; frame < mesh.size(); ++frame) mesh.check(frame);
    body.mesh = std::make_shared<MeshModel>(makeModel(mesh, num_threads_));
    if (entry.self_collision && isSoup(mesh.firstVertices(), mesh.triangles()))
      notes.push_back(mesh.path(0) +
                      ": no two triangles share a vertex: neighbours will be reported as "
                      "contacts of the mesh with itself. Join its vertices before");
    const std::string gaps = noteOnGaps(entry.meshes);
    if (!gaps.empty()) notes.push_back(gaps);
    if (entry.deforms())
      body.frames.emplace(std::move(mesh));
    else
      shared = body.mesh;
  } else {
    body.mesh = shared;
  }
  body.geometry = {body.mesh, body.mesh->model.get()};
  return body;
}

void SceneObjects::addObject(const ObjectEntry& entry, Body body) {
  body.object = std::make_unique<Object>(body.geometry, motionOf(entry, 0));
  Object* const object = body.object.get();
  manager_.registerObject(object);
  manager_.setFilter(object, file_.groups().filterOf(entry.group));
  if (entry.thickness > 0) manager_.setThickness(object, entry.thickness);
  if (entry.min_approach_speed > 0)
    manager_.setMinApproachSpeed(object, entry.min_approach_speed);
  if (entry.self_collision) manager_.setSelfCollision(object, true);
  if (entry.changes()) changing_.push_back(bodies_.size());
  numbers_[object] = bodies_.size();
  bodies_.push_back(std::move(body));
}

void SceneObjects::read(std::size_t step) {
  for (const std::size_t i : changing_) {
    Body& body = bodies_[i];
    if (!body.frames) continue;
    // The end of a step is the beginning of the next one.
    if (body.num_read == step + 1)
      body.from.swap(body.to);
    else
      body.from = body.frames->read(step);
    body.to = body.frames->read(step + 1);
    body.num_read = step + 2;
  }
}

void SceneObjects::move(std::size_t step) {
  std::vector<Object*> objects;
  std::vector<Motion> motions;
  for (const std::size_t i : changing_) {
    Body& body = bodies_[i];
    if (body.frames)
      updateModel(*body.mesh->model, body.from, body.to, body.frames->path(step + 1));
    objects.push_back(body.object.get());
    motions.push_back(motionOf(file_.objects()[i], step));
  }
  manager_.setMotion(objects, motions);
}

std::string SceneObjects::kindOf(std::size_t i) const {
  const ObjectEntry& entry = file_.objects()[i];
  if (entry.shape) return entry.shape->type;
  return entry.meshes.empty() ? "octree" : entry.deforms() ? "frames" : "mesh";
}

std::size_t SceneObjects::numTriangles(std::size_t i) const {
  const auto& mesh = bodies_[i].mesh;
  return mesh ? static_cast<std::size_t>(mesh->model->num_tris) : 0;
}

fcl::Primitive SceneObjects::primitiveOf(const MeshModel& mesh, std::intptr_t b) const {
  const auto number = static_cast<std::size_t>(b);
  const auto num_triangles = static_cast<std::size_t>(mesh.model->num_tris);
  if (number < num_triangles) return {fcl::PrimitiveKind::kTriangle, number};
  return mesh.free.at(number - num_triangles);
}

std::string SceneObjects::partName(std::size_t i, std::intptr_t b) const {
  const auto& mesh = bodies_[i].mesh;
  if (b < 0) return "";
  if (!mesh) return std::to_string(b);
  const fcl::Primitive primitive = primitiveOf(*mesh, b);
  return fcl_ccd::nameOf(primitive.kind) + std::to_string(primitive.index);
}

std::string SceneObjects::partWords(std::size_t i, std::intptr_t b) const {
  const auto& mesh = bodies_[i].mesh;
  if (b < 0) return "";
  if (!mesh) return "cell " + std::to_string(b);
  const fcl::Primitive primitive = primitiveOf(*mesh, b);
  return wordOf(primitive.kind) + (' ' + std::to_string(primitive.index));
}

double SceneObjects::distanceOf(std::size_t i, std::size_t j) const {
  for (const PairDistance& pair : file_.pairDistances())
    if ((pair.o1 == i && pair.o2 == j) || (pair.o1 == j && pair.o2 == i))
      return pair.distance;
  return file_.objects()[i].thickness + file_.objects()[j].thickness;
}

std::string SceneObjects::withNames(const std::string& message) const {
  const std::string word = "object ";
  std::string text;
  std::size_t at = 0;
  for (std::size_t found; (found = message.find(word, at)) != std::string::npos;) {
    std::size_t end = found + word.size();
    while (end < message.size() && std::isdigit(static_cast<unsigned char>(message[end])))
      ++end;
    text += message.substr(at, end - at);
    at = end;
    const std::string digits =
        message.substr(found + word.size(), end - found - word.size());
    if (digits.empty() || digits.size() > 9) continue;
    const std::size_t number = std::stoul(digits);
    if (number < size()) text += " ('" + nameOf(number) + "')";
  }
  return text + message.substr(at);
}

}  // namespace fcl_ccd
