//! Tests of live windows; apart, because nothing else needs what looks at a window from outside.
