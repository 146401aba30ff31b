"""Hard cases: a catalogue of ladders, run in isolation, and maps of where engines are stable."""
