// A shared library that is no technique.
extern "C" __attribute__((visibility("default"))) int answer() {
  return 42;
}
