// SPDX-License-Identifier: BSD-3-Clause
#include "query/query_answer.h"

#include <cstddef>
#include <limits>
#include <utility>

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void throwError(const std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                const QueryProgress& progress) {
  const double latest =
      options.query == ContinuousQuery::kFirst ? progress.first_hi.load() : kInfinity;
  const std::size_t last = progress.answered_by.load();
  const QueryError* earliest = nullptr;
  for (std::size_t i = 0; i < tasks.size() && i <= last; ++i) {
    const std::optional<QueryError>& error = tasks[i].error;
    if (error && error->earliest <= latest &&
        (!earliest || error->earliest < earliest->earliest))
      earliest = &*error;
  }
  if (earliest) throw NonFiniteVertex(earliest->vertex);
}

void addEffort(const std::vector<TaskAnswer>& tasks, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks) {
    answer.counts += task.counts;
    answer.times.traverse += task.times.traverse;
    answer.times.test += task.times.test;
  }
}

void takeCrossing(const TaskAnswer& task, QueryAnswer& answer) {
  if (!task.has_crossing || answer.has_crossing) return;
  answer.has_crossing = true;
  answer.crossing = task.crossing;
}

void takeCrossing(const std::vector<TaskAnswer>& tasks, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks) takeCrossing(task, answer);
}

SortedContacts sorted(std::deque<FeatureContact> contacts) {
  std::vector<std::deque<FeatureContact>> lists;
  lists.push_back(std::move(contacts));
  return SortedContacts(std::move(lists));
}

/// The crossing and the earliest contact of the first task that has either.
void takeAny(const std::vector<TaskAnswer>& tasks, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks) {
    if (!task.has_crossing && !task.contacts) continue;
    takeCrossing(task, answer);
    if (!task.contacts) return;
    ContactSink sink(1, false);
    for (const FeatureContact& contact : *task.contacts) sink.add(contact);
    answer.contacts = sorted(sink.takeContacts());
    return;
  }
}

/// The contacts whose brackets begin no later than `latest`.
void takeUntil(double latest, const std::vector<TaskAnswer>& tasks,
               std::size_t max_contacts, bool may_repeat, QueryAnswer& answer) {
  ContactSink sink(max_contacts, may_repeat);
  for (const TaskAnswer& task : tasks)
    if (task.contacts)
      for (const FeatureContact& contact : *task.contacts)
        if (contact.toc_lo <= latest) sink.add(contact);
  answer.cut |= sink.isCut();
  answer.contacts = sorted(sink.takeContacts());
}

void takeAll(std::vector<TaskAnswer>& tasks, std::size_t max_contacts, bool may_repeat,
             QueryAnswer& answer) {
  std::size_t count = 0;
  for (const TaskAnswer& task : tasks) {
    answer.cut |= task.cut;
    if (task.contacts) count += task.contacts->size();
  }
  // A sink only where something may have to be left out.
  if (may_repeat || count > max_contacts)
    return takeUntil(kInfinity, tasks, max_contacts, may_repeat, answer);
  std::vector<std::deque<FeatureContact>> lists;
  for (TaskAnswer& task : tasks)
    if (task.contacts) lists.push_back(std::move(*task.contacts));
  answer.contacts = SortedContacts(std::move(lists));
}

}  // namespace

void TaskAnswer::take(NarrowPhase& leaves) {
  cut = leaves.sink().isCut();
  has_crossing = leaves.hasCrossing();
  crossing = leaves.crossing();
  if (!leaves.sink().contacts().empty()) contacts = leaves.sink().takeContacts();
  error = leaves.error();
  counts = leaves.counts();
}

QueryAnswer merge(std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                  const QueryProgress& progress, bool may_repeat) {
  throwError(tasks, options, progress);
  QueryAnswer answer;
  addEffort(tasks, answer);
  if (options.query == ContinuousQuery::kAny) {
    takeAny(tasks, answer);
    return answer;
  }
  takeCrossing(tasks, answer);
  if (options.query == ContinuousQuery::kFirst)
    takeUntil(progress.first_hi.load(), tasks, options.max_contacts, may_repeat, answer);
  else
    takeAll(tasks, options.max_contacts, may_repeat, answer);
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
