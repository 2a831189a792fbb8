#!/bin/sh
# rustc for the processor that it runs on, for tests alone (RUSTC_WORKSPACE_WRAPPER of `make tests`): kernels of lower SIMD
# levels, which nothing would run here, are not compiled. Dependencies are those of any other build.
exec "$@" -C target-cpu=native
