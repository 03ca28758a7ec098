; A robot on a grid opens locked cells with keys of the right shape and delivers keys.
;@ skill move 0 move ?to
;@ skill pick-up 0 pick-up ?k
;@ skill put-down 0 put-down ?k
;@ skill swap 0 swap ?new ?old
;@ skill unlock 0 unlock ?door
(define (domain keys)
 (:requirements :strips :typing)
 (:types cell key shape)
 (:predicates (beside ?a ?b - cell) (robot-at ?c - cell) (key-at ?k - key ?c - cell) (key-shape ?k - key ?s - shape)
  (lock-shape ?c - cell ?s - shape) (locked ?c - cell) (open ?c - cell) (holding ?k - key) (arm-empty))
 (:action move
  :parameters (?from ?to - cell)
  :precondition (and (robot-at ?from) (beside ?from ?to) (open ?to))
  :effect (and (robot-at ?to) (not (robot-at ?from))))
 (:action pick-up
  :parameters (?k - key ?c - cell)
  :precondition (and (robot-at ?c) (key-at ?k ?c) (arm-empty))
  :effect (and (holding ?k) (not (key-at ?k ?c)) (not (arm-empty))))
 (:action put-down
  :parameters (?k - key ?c - cell)
  :precondition (and (robot-at ?c) (holding ?k))
  :effect (and (key-at ?k ?c) (arm-empty) (not (holding ?k))))
 (:action swap
  :parameters (?new ?old - key ?c - cell)
  :precondition (and (robot-at ?c) (key-at ?new ?c) (holding ?old))
  :effect (and (holding ?new) (key-at ?old ?c) (not (holding ?old)) (not (key-at ?new ?c))))
 (:action unlock
  :parameters (?c ?door - cell ?k - key ?s - shape)
  :precondition (and (robot-at ?c) (beside ?c ?door) (holding ?k) (key-shape ?k ?s) (lock-shape ?door ?s)
   (locked ?door))
  :effect (and (open ?door) (not (locked ?door)))))
