"""Questions asked of both fidelities: agreement, cost, ablation; the report and the
command line."""
