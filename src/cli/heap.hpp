#pragma once
/// The heap of the program, as glibc lets it be set; elsewhere nothing is changed. A run of milliseconds wants some ten megabytes: pages that the system has to map and to zero one by one took a quarter of it.

namespace pwlsim::cli {

/// Memory that is given back is kept, as the next event wants it again, and large pages are asked for. Before anything is read.
void prepare_heap();
/// Threads use the first one's heap. Before the first of them starts, and where one works at a time: others would wait for each other.
void share_heap();

}  // namespace pwlsim::cli
