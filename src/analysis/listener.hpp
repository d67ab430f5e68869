#pragma once
/// Stands between an engine and those that it tells: rows, events and pieces come to it instead of to them.

#include "engine/run.hpp"

namespace pwlsim::analysis {

class Listener : public engine::RowSink, public engine::EventWatcher, public engine::PieceSink {
 public:
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 protected:
  Listener(const engine::Request& request, engine::RowSink& rows)
      : request_(request), rows_(rows), watcher_(request.watcher), pieces_(request.probes.sink) {
    if (watcher_ != nullptr) request_.watcher = this;
    if (pieces_ != nullptr) request_.probes.sink = this;
  }

  engine::Request request_;  ///< with this in place of those that are told
  engine::RowSink& rows_;
  engine::EventWatcher* watcher_;  ///< may be null, and is not called then
  engine::PieceSink* pieces_;      ///< likewise
};

}  // namespace pwlsim::analysis
