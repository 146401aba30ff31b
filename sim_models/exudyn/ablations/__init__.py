"""The same linkage with fewer coordinates or with more than it needs: what each costs."""
