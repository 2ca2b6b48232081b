"""Contact of pad faces with rail walls: springs, compliant contact, friction with sticking."""
