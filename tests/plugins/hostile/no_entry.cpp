extern "C" __attribute__((visibility("default"))) int graticule_plugin_entry_v2() { return 0; }
